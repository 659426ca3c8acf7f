// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/simplex_overlaps.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** The points of a cell that are vertices of its simplices: corners, centres of faces in three
   * dimensions, and the centre. */
  template <int dim>
  struct CellPoints
  {
    static constexpr unsigned int n_points = dim == 3 ? 15 : 5;
    static constexpr unsigned int n_simplices = dim == 3 ? 24 : 4;

    std::array<typename SubCells<dim>::Shares, n_points> shares;
    /** The points of each simplex of CellSimplices::all(); entries beyond repeat the first. */
    std::array<std::array<std::uint8_t, 8>, n_simplices> vertices;
    std::array<unsigned int, n_simplices> bits; ///< of its points

    static const CellPoints &instance();

  private:
    CellPoints();
  };

  /** An old cell by its points and simplices. */
  template <int dim>
  class SimplexCell
  {
  public:
    explicit SimplexCell(const typename SubCells<dim>::Corners &corners);

    dealii::Point<dim> lower, upper; ///< of the box around its points
    double place[dim][16];           ///< of points; those beyond repeat the centre
    /** Of a simplex, zero where it is turned over [L^dim]. */
    std::array<double, CellPoints<dim>::n_simplices> volume;

    dealii::Point<dim> point(const unsigned int number) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = place[d][number];
      return result;
    }

    /** The coordinates in a simplex of a positive volume of four @p places, by component. */
    TOMBOLO_ALWAYS_INLINE void evaluate(const unsigned int simplex, const NodeLanes (&places)[dim],
                                        NodeLanes (&coordinates)[dim + 1]) const
    {
      const Functions &of = functions[simplex];
      coordinates[0] = 1.;
      NodeLanes offset[dim];
      for (unsigned int d = 0; d < dim; ++d)
        offset[d] = places[d] - of.origin[d];
      for (unsigned int k = 0; k < dim; ++k)
      {
        coordinates[k + 1] = of.gradient[k][0] * offset[0];
        for (unsigned int d = 1; d < dim; ++d)
          coordinates[k + 1] += of.gradient[k][d] * offset[d];
        coordinates[0] -= coordinates[k + 1];
      }
    }

  private:
    /** Barycentric coordinates but the first. */
    struct Functions
    {
      double origin[dim];
      double gradient[dim][dim];
    };

    std::array<Functions, CellPoints<dim>::n_simplices> functions;
  };

  /** A new simplex, and what old simplices have in common with it. Buffers are kept from one to the
   * next. */
  template <int dim>
  class SimplexPairs
  {
  public:
    /** An old simplex that may have something in common with the new one. */
    struct Pair
    {
      std::size_t cell; ///< as it was given
      unsigned int simplex;
      /** The coordinates of the old simplex at the vertices of the new one. */
      double old_at_new[dim + 1][4];
    };

    /** Goes on to another new simplex. Returns whether it has a positive volume. */
    bool start(const typename CellSimplices<dim>::Vertices &vertices);

    double volume() const
    {
      return volume_of_new;
    }

    /** Adds the simplices of a cell. */
    void add_cell(const SimplexCell<dim> &cell, std::size_t number);

    /** Calls @p use(pair, volume over that of the new simplex) for all that have been added, where
     * the volume is positive. */
    template <typename Use>
    void for_volumes(const Use &use)
    {
      overlaps.clip();
      for (const unsigned int number : overlaps.left())
        if (const double volume = overlaps.volume(number); volume > 0.)
          use(pairs[number], volume);
    }

    /** Calls @p use(pair, OverlapMoments of it) likewise. */
    template <typename Use>
    void for_moments(const Use &use)
    {
      overlaps.clip();
      OverlapMoments<dim> moments;
      for (const unsigned int number : overlaps.left())
      {
        overlaps.find_moments(number, moments);
        if (!(moments.volume > 0.))
          continue;
        moments.finish(pairs[number].old_at_new);
        use(pairs[number], moments);
      }
    }

  private:
    dealii::Point<dim> lower, upper;
    double volume_of_new = 0;
    NodeLanes vertices[dim]; // by component; those beyond repeat the first
    double origin[dim], gradient[dim][dim];
    SimplexOverlaps<dim> overlaps;
    std::vector<Pair> pairs;
  };
} // namespace tombolo
