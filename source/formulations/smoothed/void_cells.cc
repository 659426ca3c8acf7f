// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/void_cells.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/mesh/part_cells.h>

#include <deal.II/grid/grid_tools.h>

#include <optional>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  bool VoidCells<dim>::is_of_part(const Cell &cell) const
  {
    return part_cells->part_of(cell) == part;
  }

  template <int dim>
  void VoidCells<dim>::initialize(const PartSetup<dim> &setup, const Predicate<dim> &is_void)
  {
    nodes = setup.nodes;
    part_cells = setup.part_cells;
    part = setup.index;
    std::vector<bool> found;
    std::string failure;
    try
    {
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() && is_of_part(cell))
          found.push_back(is_void(cell->center()));
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<InputError>(failure, setup.communicator);
    set(found);
  }

  template <int dim>
  void VoidCells<dim>::set(const std::vector<bool> &is_void)
  {
    const auto &triangulation = nodes->dof_handler().get_triangulation();
    of_owned = is_void;
    flags.assign(triangulation.n_active_cells(), 0);
    std::size_t c = 0;
    for (const auto &cell : nodes->dof_handler().active_cell_iterators())
      if (cell->is_locally_owned() && is_of_part(cell))
        flags[cell->active_cell_index()] = is_void[c++] ? 1 : 0;
    GridTools::exchange_cell_data_to_ghosts<std::uint8_t, DoFHandler<dim>>(
        nodes->dof_handler(), [this](const Cell &cell) { return flags[cell->active_cell_index()]; },
        [this](const Cell &cell, const std::uint8_t &flag)
        { flags[cell->active_cell_index()] = flag; });
  }

  template class VoidCells<2>;
  template class VoidCells<3>;
} // namespace tombolo
