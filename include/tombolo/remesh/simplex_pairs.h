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
    static constexpr unsigned int centre = n_points - 1; ///< the last vertex of all simplices

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
    double place[dim][16];           ///< of points; those beyond repeat the first
    /** Of a simplex, zero where it is turned over [L^dim]. */
    std::array<double, CellPoints<dim>::n_simplices> volume;

    dealii::Point<dim> point(const unsigned int number) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = place[d][number];
      return result;
    }

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

    std::array<Gradients, CellPoints<dim>::n_simplices> gradients_of_simplices;
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
      /** The coordinates of the old simplex at the vertices of the new one, rows. */
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
    /** The simplices of a cell that are not all behind one side of the new one, where the points
     * @p behind each side are bits. Returns how many there are. */
    static unsigned int find_candidates(const SimplexCell<dim> &cell,
                                        const unsigned int (&behind)[dim + 1],
                                        unsigned int (&candidates)[CellPoints<dim>::n_simplices]);

    typename CellSimplices<dim>::Vertices vertices;
    dealii::Point<dim> lower, upper;
    double volume_of_new = 0;
    double gradient[dim][dim]; // of coordinates but the first
    SimplexOverlaps<dim> overlaps;
    std::vector<Pair> pairs; // the first n_pairs of them
    std::size_t n_pairs = 0;
  };
} // namespace tombolo
