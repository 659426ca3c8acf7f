// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace tombolo
{
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
