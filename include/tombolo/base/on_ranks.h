// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/exceptions.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace tombolo
{
  namespace internal
  {
    // These are no templates: those of deal.II take a second to compile in each source and for each
    // type, and compress what they gather.
    std::vector<std::string> broadcast_texts(MPI_Comm communicator,
                                             const std::vector<std::string> &texts);

    /** How many items the ranks before each one have, and all. Collective. */
    std::vector<int> begin_of_ranks(std::size_t n_items, MPI_Comm communicator);

    /** Items of @p size bytes of all ranks. Collective. */
    void gather_items(const void *own, void *all, std::size_t size, const std::vector<int> &begin,
                      MPI_Comm communicator);

    std::map<unsigned int, std::vector<char>>
    exchange_bytes(const std::map<unsigned int, std::vector<char>> &for_ranks,
                   MPI_Comm communicator);
  } // namespace internal

  /** What @p make() returns on the first rank, the only one that calls it, on all. Collective. */
  template <typename Make>
  auto from_first_rank(const MPI_Comm communicator, const Make &make)
  {
    decltype(make()) result{};
    if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
      result = make();
    if constexpr (std::is_same_v<decltype(result), std::vector<std::string>>)
      return internal::broadcast_texts(communicator, result);
    else if constexpr (std::is_same_v<decltype(result), std::string>)
      return internal::broadcast_texts(communicator, {result}).front();
    else
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

  /** The items of all ranks after each other, in the order of the ranks, which begin at @p begin.
   * Collective. */
  template <typename Item>
  std::vector<Item> from_all_ranks(const std::vector<Item> &own_items, const MPI_Comm communicator,
                                   std::vector<int> &begin)
  {
    static_assert(std::is_trivially_copyable_v<Item>);
    begin = internal::begin_of_ranks(own_items.size(), communicator);
    std::vector<Item> all(static_cast<std::size_t>(begin.back()));
    internal::gather_items(own_items.data(), all.data(), sizeof(Item), begin, communicator);
    return all;
  }

  /** The items of all ranks after each other, in the order of the ranks. Collective. */
  template <typename Item>
  std::vector<Item> from_all_ranks(const std::vector<Item> &own_items, const MPI_Comm communicator)
  {
    std::vector<int> begin;
    return from_all_ranks(own_items, communicator, begin);
  }

  /** The same of items of @p n_values values each, whose @p begin is known. Collective. */
  template <typename Value>
  std::vector<Value> from_all_ranks(const std::vector<Value> &own_values,
                                    const unsigned int n_values, const std::vector<int> &begin,
                                    const MPI_Comm communicator)
  {
    static_assert(std::is_trivially_copyable_v<Value>);
    std::vector<Value> all(n_values * static_cast<std::size_t>(begin.back()));
    internal::gather_items(own_values.data(), all.data(), n_values * sizeof(Value), begin,
                           communicator);
    return all;
  }

  /** The items of each rank, on all of them. Collective. */
  template <typename Item>
  std::vector<std::vector<Item>> items_by_rank(const std::vector<Item> &own_items,
                                               const MPI_Comm communicator)
  {
    std::vector<int> begin;
    const std::vector<Item> all = from_all_ranks(own_items, communicator, begin);
    std::vector<std::vector<Item>> result;
    for (std::size_t rank = 0; rank + 1 < begin.size(); ++rank)
      result.emplace_back(all.begin() + begin[rank], all.begin() + begin[rank + 1]);
    return result;
  }

  /** Every rank receives what others have for it, by rank, and what it has for itself, which is
   * moved. Collective. */
  template <typename Item>
  std::map<unsigned int, std::vector<Item>>
  exchange_by_rank(std::map<unsigned int, std::vector<Item>> for_ranks, const MPI_Comm communicator)
  {
    static_assert(std::is_trivially_copyable_v<Item>);
    std::map<unsigned int, std::vector<Item>> result;
    result.insert(for_ranks.extract(dealii::Utilities::MPI::this_mpi_process(communicator)));
    std::map<unsigned int, std::vector<char>> to_send;
    for (const auto &[rank, items] : for_ranks)
    {
      const auto *const begin = reinterpret_cast<const char *>(items.data());
      to_send[rank].assign(begin, begin + items.size() * sizeof(Item));
    }
    for (const auto &[rank, bytes] : internal::exchange_bytes(to_send, communicator))
    {
      std::vector<Item> &items = result[rank];
      items.resize(bytes.size() / sizeof(Item));
      std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char *>(items.data()));
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
