// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/state/nodal_vector.h>

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

  /** The same of slot 0 of @p values at these owned nodes. Collective. */
  inline std::array<double, 2> mean_and_largest(const NodalVector &values,
                                                const std::vector<unsigned int> &nodes)
  {
    std::vector<double> of_nodes;
    for (const unsigned int node : nodes)
      of_nodes.push_back(*values.node(node));
    return mean_and_largest(of_nodes, values.partition()->communicator());
  }
} // namespace tombolo
