// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/grid/tria_description.h>

#include <vector>

namespace tombolo
{
  /**
   * Turns cells in space to axes that depend on their places and not on the order in which a file
   * has their corners, so that neither do numbers that the axes decide, as which corners have
   * sub-cells (SubCells). Edges that are opposite to each other in cells have one direction: that
   * in which the lowest of them along a fixed direction ascends. Cells whose edges have no common
   * directions (which deal.II orders where it can) stay, and so do cells in the plane.
   */
  template <int dim>
  void turn_axes_by_place(const std::vector<dealii::Point<dim>> &vertices,
                          std::vector<dealii::CellData<dim>> &cells);
} // namespace tombolo
