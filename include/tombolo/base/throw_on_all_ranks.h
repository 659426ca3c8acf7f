// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** The text of each rank, on all of them. Collective. */
  std::vector<std::string> texts_of_ranks(MPI_Comm communicator, const std::string &text);

  /** Throws the same @p Error on every rank if any rank has a message: that of the lowest such
   * rank. For failures that only one rank can detect: if it threw alone, the others would wait for
   * it in their next exchange. Collective. */
  template <typename Error>
  void throw_on_all_ranks(const std::string &message, const MPI_Comm communicator)
  {
    for (const std::string &of_rank : texts_of_ranks(communicator, message))
      if (!of_rank.empty())
        throw Error(of_rank);
  }
} // namespace tombolo
