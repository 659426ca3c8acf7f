// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_simplices.h>

#include <array>
#include <cstdint>

namespace tombolo
{
  /** The points of a cell that are vertices of its simplices (CellSimplices): corners, centres of
   * faces in three dimensions, and the centre. */
  template <int dim>
  struct SimplexPoints
  {
    static constexpr unsigned int n_points = dim == 3 ? 15 : 5;
    static constexpr unsigned int n_simplices = dim == 3 ? 24 : 4;
    static constexpr unsigned int n_padded = dim == 3 ? 24 : 8; ///< of simplices, to eight
    static constexpr unsigned int centre = n_points - 1; ///< the last vertex of all simplices
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    std::array<typename SubCells<dim>::Shares, n_points> shares;
    /** The points of each simplex of CellSimplices::all(); entries beyond repeat the first. */
    std::array<std::array<std::uint8_t, 8>, n_simplices> vertices;
    /** Of each simplex. */
    std::array<unsigned int, n_simplices> sub_cell;
    /** The points of each sub-cell, as bits. */
    std::array<unsigned int, SubCells<dim>::n_sub_cells> points_of_sub_cell{};

    /** The same by vertex and simplex, eight simplices at a time; those beyond repeat the first. */
    std::uint8_t of_vertex[dim + 1][n_padded];
    /** The shares by corner and point; points beyond repeat the first. */
    double of_corner[n_corners][16];
    /** The shares by point and corner, and their sums over the vertices of each simplex. Corners
     * beyond are zero. */
    double of_point[n_points][8], of_simplex[n_simplices][8];

    /** The simplices, as bits, that have at least one of these @p points, which are 16 bits. */
    unsigned int simplices_at(const unsigned int points) const
    {
      return simplices_of_low[points & 255u] | simplices_of_high[points >> 8];
    }

    static const SimplexPoints &instance();

  private:
    SimplexPoints();
    void fill_tables();

    std::array<unsigned int, 256> simplices_of_low{}, simplices_of_high{}; // by bits of points
  };
} // namespace tombolo
