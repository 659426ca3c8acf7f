// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/cells_of_part.h>

#include <deal.II/grid/grid_tools.h>

#include <cstdint>

namespace tombolo
{
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

  template <int dim>
  double largest_cell_diameter(const Nodes<dim> &nodes)
  {
    return dealii::Utilities::MPI::max(
        dealii::GridTools::maximal_cell_diameter(nodes.dof_handler().get_triangulation()),
        nodes.communicator());
  }

  template void update_ghost_flags(const Nodes<2> &, std::vector<bool> &);
  template void update_ghost_flags(const Nodes<3> &, std::vector<bool> &);
  template double largest_cell_diameter(const Nodes<2> &);
  template double largest_cell_diameter(const Nodes<3> &);
} // namespace tombolo
