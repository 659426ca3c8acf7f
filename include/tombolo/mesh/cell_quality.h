// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>

#include <array>

namespace tombolo
{
  /** The vertices of a cell in deal.II's (lexicographic) order. */
  template <int dim>
  using CellVertices = std::array<dealii::Point<dim>, dealii::GeometryInfo<dim>::vertices_per_cell>;

  /** The smallest determinant of the unit edge vectors at the corners of a cell (the scaled
   * Jacobian): one for a brick of any proportions, zero where an edge has no length or a corner is
   * flat, negative where a corner is turned inside out. */
  template <int dim>
  double smallest_corner(const CellVertices<dim> &vertices);

  /** The mean of the corner determinants: negative for a cell that is numbered the wrong way
   * round, zero for a flat one. Has the units of a volume. */
  template <int dim>
  double mean_corner_volume(const CellVertices<dim> &vertices);

  /** smallest_corner() of a cell that can be used is larger than this. */
  constexpr double smallest_usable_corner = 1e-6;
} // namespace tombolo
