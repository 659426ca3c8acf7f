// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
  /**
   * The sum of one number per rank, added in the order of the ranks: the same bits on every rank
   * and at every repetition, which MPI_Allreduce does not promise. Collective.
   */
  double ordered_sum(double local, MPI_Comm communicator);

  /** As above for each component of vectors that have the same length on all ranks. For short
   * vectors: every rank receives those of all ranks. */
  std::vector<double> ordered_sum(const std::vector<double> &local, MPI_Comm communicator);

  template <std::size_t n>
  std::array<double, n> ordered_sum(const std::array<double, n> &local, const MPI_Comm communicator)
  {
    const std::vector<double> sum =
        ordered_sum(std::vector<double>(local.begin(), local.end()), communicator);
    std::array<double, n> result{};
    std::copy_n(sum.begin(), n, result.begin());
    return result;
  }
} // namespace tombolo
