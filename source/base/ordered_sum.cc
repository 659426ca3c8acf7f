// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/ordered_sum.h>

namespace tombolo
{
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
