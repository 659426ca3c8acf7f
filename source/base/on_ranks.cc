// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>

#include <numeric>

namespace tombolo
{
  std::vector<std::string> texts_of_ranks(const MPI_Comm communicator, const std::string &text)
  {
    // Mostly there is none.
    if (dealii::Utilities::MPI::max(text.empty() ? 0 : 1, communicator) == 0)
      return std::vector<std::string>(dealii::Utilities::MPI::n_mpi_processes(communicator));
    return dealii::Utilities::MPI::all_gather(communicator, text);
  }

  namespace internal
  {
    std::vector<std::string> broadcast_texts(const MPI_Comm communicator,
                                             const std::vector<std::string> &texts)
    {
      return dealii::Utilities::MPI::broadcast(communicator, texts, 0);
    }

    std::vector<int> begin_of_ranks(const std::size_t n_items, const MPI_Comm communicator)
    {
      const auto n = static_cast<int>(n_items);
      std::vector<int> begin(dealii::Utilities::MPI::n_mpi_processes(communicator) + 1, 0);
      MPI_Allgather(&n, 1, MPI_INT, begin.data() + 1, 1, MPI_INT, communicator);
      std::partial_sum(begin.begin(), begin.end(), begin.begin());
      return begin;
    }

    void gather_items(const void *const own, void *const all, const std::size_t size,
                      const std::vector<int> &begin, const MPI_Comm communicator)
    {
      MPI_Datatype type;
      MPI_Type_contiguous(static_cast<int>(size), MPI_BYTE, &type);
      MPI_Type_commit(&type);
      std::vector<int> lengths(begin.size());
      std::adjacent_difference(begin.begin(), begin.end(), lengths.begin());
      const int *const n_of_ranks = lengths.data() + 1;
      MPI_Allgatherv(own, n_of_ranks[dealii::Utilities::MPI::this_mpi_process(communicator)], type,
                     all, n_of_ranks, begin.data(), type, communicator);
      MPI_Type_free(&type);
    }

    std::map<unsigned int, std::vector<char>>
    exchange_bytes(const std::map<unsigned int, std::vector<char>> &for_ranks,
                   const MPI_Comm communicator)
    {
      return dealii::Utilities::MPI::some_to_some(communicator, for_ranks);
    }
  } // namespace internal

  double ordered_sum(const double local, const MPI_Comm communicator)
  {
    return ordered_sum(std::vector<double>(1, local), communicator)[0];
  }

  std::vector<double> ordered_sum(const std::vector<double> &local, const MPI_Comm communicator)
  {
    int n_ranks = 0;
    MPI_Comm_size(communicator, &n_ranks);
    const std::size_t n = local.size();
    std::vector<double> all(n * static_cast<std::size_t>(n_ranks));
    MPI_Allgather(local.data(), static_cast<int>(n), MPI_DOUBLE, all.data(), static_cast<int>(n),
                  MPI_DOUBLE, communicator);
    std::vector<double> sum(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n));
    for (std::size_t rank = 1; rank < static_cast<std::size_t>(n_ranks); ++rank)
      for (std::size_t i = 0; i < n; ++i)
        sum[i] += all[rank * n + i];
    return sum;
  }
} // namespace tombolo
