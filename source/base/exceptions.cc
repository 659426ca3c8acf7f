// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  std::vector<std::string> texts_of_ranks(const MPI_Comm communicator, const std::string &text)
  {
    return dealii::Utilities::MPI::all_gather(communicator, text);
  }
} // namespace tombolo
