// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/exceptions.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

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

  /** The values of all ranks after each other, in the order of the ranks. Collective. */
  template <typename Value>
  std::vector<Value> of_all_ranks(const std::vector<Value> &of_rank, const MPI_Comm communicator)
  {
    static_assert(std::is_trivially_copyable_v<Value>);
    const auto *const begin = reinterpret_cast<const char *>(of_rank.data());
    const std::vector<char> bytes(begin, begin + of_rank.size() * sizeof(Value));
    std::vector<Value> result;
    for (const std::vector<char> &of_one : dealii::Utilities::MPI::all_gather(communicator, bytes))
    {
      const std::size_t before = result.size();
      result.resize(before + of_one.size() / sizeof(Value));
      std::copy(of_one.begin(), of_one.end(), reinterpret_cast<char *>(result.data() + before));
    }
    return result;
  }

  /** Whether any of the items of any rank fulfils the condition. Collective. */
  template <typename Items, typename Condition>
  bool any_of_all_ranks(const Items &items, const Condition &condition, const MPI_Comm communicator)
  {
    const bool is_here = std::any_of(items.begin(), items.end(), condition);
    return dealii::Utilities::MPI::max(is_here ? 1 : 0, communicator) == 1;
  }
} // namespace tombolo
