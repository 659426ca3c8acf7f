// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>

#include <deal.II/grid/grid_tools.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /** Sets the flags of ghost cells to those that their owners have. Flags are by the index of
   * active cells. Collective. */
  template <int dim>
  void update_ghost_flags(const Nodes<dim> &nodes, std::vector<bool> &flags)
  {
    using Cell = typename Nodes<dim>::Cell;
    dealii::GridTools::exchange_cell_data_to_ghosts<std::uint8_t, dealii::DoFHandler<dim>>(
        nodes.dof_handler(),
        [&](const Cell &cell) { return std::uint8_t(flags[cell->active_cell_index()] ? 1 : 0); },
        [&](const Cell &cell, const std::uint8_t &flag)
        { flags[cell->active_cell_index()] = flag != 0; });
  }
} // namespace tombolo
