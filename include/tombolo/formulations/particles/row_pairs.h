// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <cstddef>

namespace tombolo
{
  /**
   * n_lanes pairs of the particle i of a row with its neighbours j, at the present positions. Each
   * pair of particles stands in the rows of both: what acts between them is the sum of a half from
   * either row, which goes to both ends with opposite signs, so that no rank needs more of the
   * particles of another than where they are.
   */
  template <int dim>
  struct RowPairs
  {
    /** Those from neighbour @p first of the row on, whose particle @p particle is at @p own. Lanes
     * beyond the end of the row are pairs of the particle with itself, without weight. */
    RowPairs(const Stencils::Row &row, const unsigned int first, const unsigned int particle,
             const Lanes (&own)[dim], const double *position)
        : n(std::min(n_lanes, row.size - first))
    {
      NodeLanes of_nodes[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        const bool is_used = lane < n;
        node[lane] = is_used ? row.neighbour[first + lane] : particle;
        of_nodes[lane] = is_used ? load_node(row.gradient + Stencils::n_gradient * (first + lane))
                                 : NodeLanes(0.);
      }
      nodes_to_lanes(of_nodes, gradient);
      gather_nodes(position, node, offset);
      Lanes squared_gradient = 0.;
      squared = 0.;
      for (unsigned int d = 0; d < dim; ++d)
      {
        offset[d] -= own[d];
        squared += offset[d] * offset[d];
        squared_gradient += gradient[d] * gradient[d];
      }
      const LaneMask is_pair = squared > 0.;
      where(!is_pair, squared) = 1.;
      weight = square_root(squared_gradient / squared);
      where(!is_pair, weight) = 0.;
    }

    /** Σ_d a_d (x_j - x_i)_d */
    Lanes along_offset(const Lanes (&a)[dim]) const
    {
      Lanes sum = a[0] * offset[0];
      for (unsigned int d = 1; d < dim; ++d)
        sum += a[d] * offset[d];
      return sum;
    }

    unsigned int n; ///< pairs of the row among the lanes
    unsigned int node[n_lanes];
    Lanes offset[dim];   ///< x_j - x_i
    Lanes squared;       ///< its square; 1 for a particle with itself
    Lanes gradient[dim]; ///< ∇φ_j of the row
    Lanes weight;        ///< |∇φ_j|/|x_j - x_i|; 0 for a particle with itself
  };

  /** A nodal value of one particle in all lanes. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void spread_node(const double *field, const unsigned int local,
                                         Lanes (&components)[dim])
  {
    for (unsigned int d = 0; d < dim; ++d)
      components[d] = field[static_cast<std::size_t>(local) * NodeLanes::size() + d];
  }

  /** The sum of the lanes. */
  TOMBOLO_ALWAYS_INLINE double sum_of_lanes(const Lanes &value)
  {
    double sum = value[0];
    for (unsigned int lane = 1; lane < n_lanes; ++lane)
      sum += value[lane];
    return sum;
  }
} // namespace tombolo
