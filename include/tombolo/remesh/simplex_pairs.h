// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/simplex_overlaps.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** An old cell by its points and simplices. */
  template <int dim>
  class SimplexCell
  {
  public:
    explicit SimplexCell(const typename SubCells<dim>::Corners &corners);

    dealii::Point<dim> lower, upper;             ///< of the box around its points
    double place[dim][16];                       ///< of points; those beyond repeat the first
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
      double entries[dim][4];
    };

    std::array<Gradients, SimplexPoints<dim>::n_simplices> gradients_of_simplices;
  };

  /** A new simplex, and what the simplices of old cells have in common with it. Buffers are kept
   * from one to the next. */
  template <int dim>
  class SimplexPairs
  {
  public:
    /** An old simplex that may have something in common with the new one. */
    struct Pair
    {
      /** The coordinates of the old simplex at the vertices of the new one, rows. In two
       * dimensions the last row repeats the first. */
      double old_at_new[4][4];
      unsigned int cell; ///< its place in the order of add_cell()
      unsigned int simplex;
    };

    /** Forgets all old cells. */
    void clear_cells()
    {
      cells.clear();
    }

    /** Adds an old cell, which must stay where it is. */
    void add_cell(const SimplexCell<dim> &cell);

    /** Goes on to another new simplex, of a positive volume, with all old simplices that may have
     * something in common with it. */
    void start(const SimplexCell<dim> &of_new, unsigned int simplex);

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
    void set_place(const SimplexCell<dim> &of_new, unsigned int simplex);
    void add_pairs(unsigned int number);
    void add_pair(const SimplexCell<dim> &cell, unsigned int number, unsigned int simplex);

    std::vector<const SimplexCell<dim> *> cells;
    std::vector<double> box; // of cells: lower and upper ends by component, eight cells at a time
    dealii::Point<dim> lower, upper;        // of the new simplex
    double origin[dim], gradient[dim][dim]; // of coordinates but the first
    double place[dim][16];                  // each component of vertices four times
    SimplexOverlaps<dim> overlaps;
    std::vector<Pair> pairs; // the first n_pairs of them, and room for those of one cell
    std::size_t n_pairs = 0;
  };
} // namespace tombolo
