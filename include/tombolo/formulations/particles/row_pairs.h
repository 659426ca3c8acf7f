// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace tombolo
{
  /** A function of the distance that ends at a radius, as straight lines between equal intervals:
   * what pair terms need of a kernel beyond its gradient, without a call of the kernel per pair. */
  class RadialTable
  {
  public:
    /** Zero everywhere. */
    RadialTable() = default;

    /** Of the values of @p function at distances from 0 to @p radius; zero beyond. */
    RadialTable(const double radius, const std::function<double(double)> &function)
        : intervals_per_length(n_intervals / radius), values(n_intervals + 2, 0.)
    {
      for (std::size_t k = 0; k < n_intervals; ++k)
        values[k] = function(static_cast<double>(k) / intervals_per_length);
    }

    double operator()(const double distance) const
    {
      const double place = std::min(distance * intervals_per_length, double(n_intervals));
      const auto interval = static_cast<std::size_t>(place);
      const double fraction = place - static_cast<double>(interval);
      return values[interval] + fraction * (values[interval + 1] - values[interval]);
    }

    Lanes operator()(const Lanes &distance) const
    {
      alignas(64) double entries[n_lanes];
      store_lanes(distance, entries);
      for (double &entry : entries)
        entry = (*this)(entry);
      return load_lanes(entries);
    }

  private:
    static constexpr std::size_t n_intervals = 2048;

    double intervals_per_length = 0.;
    std::vector<double> values = std::vector<double>(n_intervals + 2, 0.);
  };

  /** The pairs of particles of one part: the neighbours of rows, whatever the rows do with them,
   * and what makes kernel gradients of distances. It points to data of others. */
  struct PairRows
  {
    const Stencils *shape;
    const double *node_volume; ///< V⁰ by local node as others see it, ghosts and images too
    const double
        *initial_volume;      ///< V⁰ of each row: on planes of symmetry, of its part in the body
    const double *volume;     ///< V of each row
    const RadialTable *slope; ///< |dW/dr| over the distance
  };

  /**
   * n_lanes pairs of the particle i of a row with its neighbours j, at the present positions. Each
   * pair of particles stands in the rows of both: what acts between them is the sum of a half from
   * either row, which goes to both ends with opposite signs, so that no rank needs more of the
   * particles of another than where they are and how large they were.
   */
  template <int dim>
  struct RowPairs
  {
    /** Those from neighbour @p first of @p row on, whose particle @p particle is at @p own. Lanes
     * beyond the end of the row are pairs of the particle with itself, without weight. */
    RowPairs(const PairRows &rows, const unsigned int row, const unsigned int first,
             const unsigned int particle, const Lanes (&own)[dim], const double *position)
        : n(std::min(n_lanes, rows.shape->row(row).size - first))
    {
      const unsigned int *const neighbour = rows.shape->row(row).neighbour + first;
      alignas(64) double volume[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        node[lane] = lane < n ? neighbour[lane] : particle;
        volume[lane] = rows.node_volume[node[lane]];
      }
      gather_nodes(position, node, offset);
      squared = 0.;
      for (unsigned int d = 0; d < dim; ++d)
      {
        offset[d] -= own[d];
        squared += offset[d] * offset[d];
      }
      const LaneMask is_pair = squared > 0.;
      where(!is_pair, squared) = 1.;
      distance = square_root(squared);
      of_row = rows.volume[row] / rows.initial_volume[row];
      other_volume = load_lanes(volume);
      where(!is_pair, other_volume) = 0.;
      weight = of_row * other_volume * (*rows.slope)(distance) / distance;
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
    Lanes offset[dim];  ///< x_j - x_i
    Lanes squared;      ///< its square; 1 for a particle with itself
    Lanes distance;     ///< its root
    double of_row;      ///< V_i/V⁰_i
    Lanes other_volume; ///< V⁰_j; 0 for a particle with itself
    /** m_j/ρ_i |dW/dr|/r, the size of ∇φ_j over the distance; 0 for a particle with itself. */
    Lanes weight;
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

  /** Calls @p use with all pairs of a row, n_lanes at a time. */
  template <int dim, typename Use>
  TOMBOLO_ALWAYS_INLINE void for_pairs_of_row(const PairRows &rows, const unsigned int row,
                                              const double *position, const Use &use)
  {
    const unsigned int particle = rows.shape->particle_node[row];
    const unsigned int n_neighbours = rows.shape->row(row).size;
    Lanes own[dim];
    spread_node(position, particle, own);
    for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      use(RowPairs<dim>(rows, row, first, particle, own, position));
  }
} // namespace tombolo
