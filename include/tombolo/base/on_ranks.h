// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/exceptions.h>

#include <string>

namespace tombolo
{
  /** What @p make() gives on the first rank, the only one that calls it, on all. Collective. */
  template <typename Make>
  auto of_first_rank(const MPI_Comm communicator, const Make &make)
  {
    decltype(make()) result{};
    if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
      result = make();
    return dealii::Utilities::MPI::broadcast(communicator, result, 0);
  }

  /** Calls @p action. Where it throws a @p Caught on any rank, throws an @p Error on all, as
   * throw_on_all_ranks(). Collective. */
  template <typename Error, typename Caught = Error, typename Action>
  void attempt_on_all_ranks(const MPI_Comm communicator, const Action &action)
  {
    std::string failure;
    try
    {
      action();
    }
    catch (const Caught &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<Error>(failure, communicator);
  }
} // namespace tombolo
