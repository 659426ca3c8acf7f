// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/simplex_overlaps.h>

#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /** An old cell by its points and simplices. */
  template <int dim>
  class SimplexCell
  {
  public:
    explicit SimplexCell(const typename SubCells<dim>::Corners &corners)
    {
      constexpr unsigned int n_simplices = SimplexPoints<dim>::n_simplices;
      const SimplexLanes<dim> lanes(corners);
      for (unsigned int d = 0; d < dim; ++d)
      {
        std::copy_n(lanes.coordinates[d], 16, coordinates[d]);
        lower[d] = *std::min_element(coordinates[d], coordinates[d] + 16);
        upper[d] = *std::max_element(coordinates[d], coordinates[d] + 16);
      }
      for (unsigned int group = 0; group < SimplexLanes<dim>::n_groups; ++group)
      {
        const auto edges = lanes.edges(group);
        counts |= bits_of(SimplexLanes<dim>::volume_factor * edges.determinant > 0.) << (8 * group);
        store_eight(SimplexLanes<dim>::volume_factor * edges.determinant,
                    volume + std::size_t(8) * group);
        EightDoubles determinant = edges.determinant;
        std::experimental::where(determinant == 0., determinant) = 1.;
        const EightDoubles inverse = 1. / determinant;
        double gradient[dim + 1][dim][8];
        for (unsigned int d = 0; d < dim; ++d)
        {
          EightDoubles centre_gradient = 0.;
          for (unsigned int k = 0; k < dim; ++k)
          {
            const EightDoubles value = inverse * edges.cofactor[k][d];
            store_eight(value, gradient[k][d]);
            centre_gradient -= value;
          }
          store_eight(centre_gradient, gradient[dim][d]);
        }
        for (unsigned int s = 8 * group; s < std::min(8 * (group + 1), n_simplices); ++s)
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int k = 0; k < 4; ++k)
              gradients_of_simplices[s].entries[d][k] = k <= dim ? gradient[k][d][s % 8] : 0.;
      }
      counts &= (1u << n_simplices) - 1;
    }

    dealii::Point<dim> lower, upper;             ///< of the box around its points
    alignas(64) double coordinates[dim][16];     ///< of points; those beyond repeat the first
    double volume[SimplexPoints<dim>::n_padded]; ///< of simplices
    /** Bits of the simplices that count: those that are not turned over or flat, or some of them.
     */
    unsigned int counts = 0;

    /** The gradients of the coordinates of a simplex of a positive volume, by component and
     * vertex. Entries beyond the last vertex are zero. */
    const double (&gradients(const unsigned int simplex) const)[dim][4]
    {
      return gradients_of_simplices[simplex].entries;
    }

  private:
    struct Gradients
    {
      alignas(32) double entries[dim][4];
    };

    std::array<Gradients, SimplexPoints<dim>::n_simplices> gradients_of_simplices;
  };

  /** A new simplex, and what the simplices of old cells have in common with it. Buffers are kept
   * from one to the next. */
  template <int dim>
  class SimplexPairs
  {
  public:
    /** An old simplex that may overlap the new one. */
    struct Pair
    {
      /** The coordinates of the old simplex at the vertices of the new one, rows. In two
       * dimensions the last row repeats the first. */
      alignas(64) double old_at_new[4][4];
      unsigned int cell; ///< its index in the order of add_cell()
      unsigned int simplex;
    };

    /** Removes all old cells. */
    void clear_cells()
    {
      cells.clear();
    }

    /** Adds an old cell, which must stay where it is. */
    void add_cell(const SimplexCell<dim> &cell)
    {
      constexpr double nowhere = 1e300;
      const std::size_t number = cells.size(), first = number / 8 * dim * 16;
      if (number % 8 == 0)
      {
        if (box.size() < first + dim * 16)
          box.resize(first + dim * 16);
        std::fill_n(box.begin() + std::ptrdiff_t(first), dim * 16, nowhere);
      }
      for (unsigned int d = 0; d < dim; ++d)
      {
        box[first + d * 16 + number % 8] = cell.lower[d];
        box[first + d * 16 + 8 + number % 8] = cell.upper[d];
      }
      cells.push_back(&cell);
    }

    /** Begins another new simplex, of a positive volume, with all old simplices that may overlap
     * it. */
    void start(const SimplexCell<dim> &new_cell, const unsigned int simplex)
    {
      overlaps.clear();
      n_pairs = 0;
      set_simplex(new_cell, simplex);
      for (unsigned int first = 0; first < cells.size(); first += 8)
      {
        unsigned int is_apart = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double *const group_box = box.data() + (std::size_t(first) / 8 * dim + d) * 16;
          is_apart |= bits_of(load_eight(group_box) > upper[d]) |
                      bits_of(load_eight(group_box + 8) < lower[d]);
        }
        for (unsigned int is_near = ~is_apart & 0xFFu; is_near != 0; is_near &= is_near - 1)
          add_pairs(first + first_bit(is_near));
      }
    }

    /** Calls @p use(pair, OverlapMoments of it) for all old simplices, where the volume is
     * positive. */
    template <typename Use>
    void for_moments(const Use &use)
    {
      overlaps.clip();
      OverlapMoments<dim> moments;
      for (const unsigned int number : overlaps.left())
      {
        overlaps.find_moments(number, moments);
        if (moments.volume() > 0.)
          use(pairs[number], moments);
      }
    }

  private:
    /** The number of the lowest bit that is set; there must be one. */
    static unsigned int first_bit(const unsigned int bits)
    {
      return static_cast<unsigned int>(__builtin_ctz(bits));
    }

    void set_simplex(const SimplexCell<dim> &new_cell, const unsigned int simplex)
    {
      const std::uint8_t *const points = SimplexPoints<dim>::instance().vertices[simplex].data();
      for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = upper[d] = origin[d] = new_cell.coordinates[d][points[0]];
        for (unsigned int k = 0; k < 4; ++k)
        {
          const double vertex_coordinate = new_cell.coordinates[d][points[k <= dim ? k : 0]];
          std::fill_n(vertex_lanes[d] + 4 * k, 4, vertex_coordinate);
          lower[d] = std::min(lower[d], vertex_coordinate);
          upper[d] = std::max(upper[d], vertex_coordinate);
        }
        for (unsigned int k = 0; k < dim; ++k)
          gradient[k][d] = new_cell.gradients(simplex)[d][k + 1];
      }
    }
    void add_pairs(const unsigned int number)
    {
      const SimplexCell<dim> &cell = *cells[number];
      const SimplexPoints<dim> &simplex_points = SimplexPoints<dim>::instance();
      alignas(64) typename SimplexOverlaps<dim>::Points points; // in the new simplex
      unsigned int in_front[dim + 1] = {};
      for (unsigned int first = 0; first < 16; first += 8)
      {
        EightDoubles offset[dim], last = 1.;
        TOMBOLO_UNROLL
        for (unsigned int d = 0; d < dim; ++d)
          offset[d] = load_eight(cell.coordinates[d] + first) - origin[d];
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < dim; ++k)
        {
          EightDoubles value = gradient[k][0] * offset[0];
          TOMBOLO_UNROLL
          for (unsigned int d = 1; d < dim; ++d)
            value += gradient[k][d] * offset[d];
          last -= value;
          store_eight(value, points[k + 1] + first);
          in_front[k + 1] |= bits_of(value > 0.) << first;
        }
        store_eight(last, points[0] + first);
        in_front[0] |= bits_of(last > 0.) << first;
      }
      // Those that are not all behind one side of the new simplex.
      unsigned int candidates = cell.counts;
      for (const unsigned int side_points : in_front)
        candidates &= simplex_points.simplices_at(side_points);
      const std::size_t first_pair = n_pairs;
      if (pairs.size() < n_pairs + SimplexPoints<dim>::n_simplices)
        pairs.resize(n_pairs + SimplexPoints<dim>::n_simplices);
      EightDoubles offset[dim][2];
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
        TOMBOLO_UNROLL
      for (unsigned int half = 0; half < 2; ++half)
        offset[d][half] = load_eight(vertex_lanes[d] + std::size_t(8) * half) -
                          cell.coordinates[d][SimplexPoints<dim>::centre];
      for (; candidates != 0; candidates &= candidates - 1)
        add_pair(cell, number, first_bit(candidates), offset);
      for (std::size_t pair = first_pair; pair < n_pairs; ++pair)
        overlaps.add(points, simplex_points.vertices[pairs[pair].simplex].data());
    }
    /** @p offset: the vertices of the new simplex from the centre of the old cell, as
     * vertex_lanes. */
    TOMBOLO_ALWAYS_INLINE void add_pair(const SimplexCell<dim> &cell, const unsigned int number,
                                        const unsigned int simplex,
                                        const EightDoubles (&offset)[dim][2])
    {
      Pair &pair = pairs[n_pairs];
      // Coordinates at the centre; with an entry beyond, which is always in front.
      alignas(32) static constexpr double centre_coordinates[4] = {0., 0., dim == 2 ? 1. : 0., 1.};
      const double(&old_gradients)[dim][4] = cell.gradients(simplex);
      EightDoubles low = repeat_four(centre_coordinates), high = low; // of two vertices each
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
      {
        const EightDoubles component_gradient = repeat_four(old_gradients[d]);
        low += offset[d][0] * component_gradient;
        high += offset[d][1] * component_gradient;
      }
      store_eight(low, pair.old_at_new[0]);
      store_eight(high, pair.old_at_new[2]);
      pair.cell = number;
      pair.simplex = simplex;
      // Unless the new one is behind a side of the old one; a sum instead of a branch, which would
      // follow no pattern.
      const unsigned int in_front = bits_of(std::experimental::max(low, high) > 0.);
      n_pairs += ((in_front | (in_front >> 4)) & 15u) == 15u ? 1 : 0;
    }

    std::vector<const SimplexCell<dim> *> cells;
    std::vector<double> box; // of cells: lower and upper ends by component, eight cells at a time
    dealii::Point<dim> lower, upper;          // of the new simplex
    double origin[dim], gradient[dim][dim];   // of coordinates but the first
    alignas(64) double vertex_lanes[dim][16]; // each component of vertices four times
    SimplexOverlaps<dim> overlaps;
    std::vector<Pair> pairs; // the first n_pairs of them, and room for those of one cell
    std::size_t n_pairs = 0;
  };
} // namespace tombolo
