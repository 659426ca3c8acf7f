// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <cstddef>
#include <numeric>
#include <vector>

namespace tombolo
{
  /** The numbers of each rank, on all of them. Utilities::MPI::all_gather() compresses what it
   * sends, one rank's to itself too, which takes longer than what is done with many numbers.
   * Collective. */
  inline std::vector<std::vector<double>> numbers_of_ranks(const std::vector<double> &of_rank,
                                                           const MPI_Comm communicator)
  {
    const auto lengths =
        dealii::Utilities::MPI::all_gather(communicator, static_cast<int>(of_rank.size()));
    std::vector<int> begin(lengths.size() + 1, 0);
    std::partial_sum(lengths.begin(), lengths.end(), begin.begin() + 1);
    std::vector<double> all(static_cast<std::size_t>(begin.back()));
    MPI_Allgatherv(of_rank.data(), static_cast<int>(of_rank.size()), MPI_DOUBLE, all.data(),
                   lengths.data(), begin.data(), MPI_DOUBLE, communicator);
    std::vector<std::vector<double>> result;
    for (std::size_t rank = 0; rank < lengths.size(); ++rank)
      result.emplace_back(all.begin() + begin[rank], all.begin() + begin[rank + 1]);
    return result;
  }
} // namespace tombolo
