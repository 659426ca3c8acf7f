// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace tombolo
{
  /** Mean and largest of @p values of all ranks; zeros without any. Collective. */
  inline std::array<double, 2> mean_and_largest(const std::vector<double> &values,
                                                const MPI_Comm communicator)
  {
    std::array<double, 2> sums{};
    double largest = std::numeric_limits<double>::lowest();
    for (const double value : values)
    {
      sums[0] += value;
      sums[1] += 1.;
      largest = std::max(largest, value);
    }
    sums = ordered_sum(sums, communicator);
    largest = dealii::Utilities::MPI::max(largest, communicator);
    if (sums[1] == 0.)
      return {};
    return {{sums[0] / sums[1], largest}};
  }
} // namespace tombolo
