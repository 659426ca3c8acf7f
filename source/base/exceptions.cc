// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  std::vector<std::string> texts_of_ranks(const MPI_Comm communicator, const std::string &text)
  {
    // Mostly there is none.
    if (dealii::Utilities::MPI::max(text.empty() ? 0 : 1, communicator) == 0)
      return std::vector<std::string>(dealii::Utilities::MPI::n_mpi_processes(communicator));
    return dealii::Utilities::MPI::all_gather(communicator, text);
  }
} // namespace tombolo
