// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/point.h>

#include <array>

namespace tombolo
{
  /** The vertices of a cell, lexicographic. */
  template <int dim>
  using CellCorners = std::array<dealii::Point<dim>, dealii::GeometryInfo<dim>::vertices_per_cell>;

  /** The corners of @p cell moved towards its centre by this @p share of their distance to it. */
  template <int dim>
  CellCorners<dim> shrunk_corners(const CellCorners<dim> &cell, double share);

  /** Whether the convex hulls of two cells have points in common: those of which no normal of a
   * face, and in space no normal of two edges, is a direction in which one lies behind the other.
   * Faces that are not plane have the normal of their diagonals. */
  template <int dim>
  bool have_points_in_common(const CellCorners<dim> &a, const CellCorners<dim> &b);
} // namespace tombolo
