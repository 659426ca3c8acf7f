// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>

#include <vector>

namespace tombolo
{
  /** Sets the flags of ghost cells to those that their owners have. Flags are by the index of
   * active cells. Collective. */
  template <int dim>
  void update_ghost_flags(const Nodes<dim> &nodes, std::vector<bool> &flags);

  /** The largest diameter of a cell [L]. Collective. */
  template <int dim>
  double largest_cell_diameter(const Nodes<dim> &nodes);

  /** The cells of a part that this rank owns, in the order of active cells of the triangulation:
   * that of Formulation::n_cells(). */
  template <int dim>
  std::vector<typename Nodes<dim>::Cell>
  cells_of_part(const Nodes<dim> &nodes, const PartCells<dim> &part_cells, const unsigned int part)
  {
    std::vector<typename Nodes<dim>::Cell> cells;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      if (cell->is_locally_owned() && part_cells.part_of(cell) == part)
        cells.push_back(cell);
    return cells;
  }
} // namespace tombolo
