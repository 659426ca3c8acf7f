// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <limits>

namespace tombolo
{
  /** The box along the axes around points; with merge_ranks() around those of all ranks. */
  template <int dim>
  struct Extent
  {
    std::array<double, dim> lowest, highest;

    Extent()
    {
      lowest.fill(std::numeric_limits<double>::max());
      highest.fill(std::numeric_limits<double>::lowest());
    }

    /** Adds a point with its first @p dim coordinates. */
    template <typename Coordinates>
    void add(const Coordinates &point)
    {
      for (unsigned int d = 0; d < dim; ++d)
      {
        lowest[d] = std::min(lowest[d], point[d]);
        highest[d] = std::max(highest[d], point[d]);
      }
    }

    /** Collective. */
    void merge_ranks(const MPI_Comm communicator)
    {
      for (unsigned int d = 0; d < dim; ++d)
      {
        lowest[d] = dealii::Utilities::MPI::min(lowest[d], communicator);
        highest[d] = dealii::Utilities::MPI::max(highest[d], communicator);
      }
    }

    double length(const unsigned int d) const
    {
      return highest[d] - lowest[d];
    }

    double longest() const
    {
      double result = 0;
      for (unsigned int d = 0; d < dim; ++d)
        result = std::max(result, length(d));
      return result;
    }
  };

  /** That of owned nodes of all ranks, at a nodal vector of positions. Collective. */
  template <int dim, typename Positions>
  Extent<dim> extent_of(const Positions &position)
  {
    Extent<dim> result;
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      result.add(position.node(i));
    result.merge_ranks(position.partition()->communicator());
    return result;
  }
} // namespace tombolo
