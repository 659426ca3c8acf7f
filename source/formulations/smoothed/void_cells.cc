// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/void_cells.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/mesh/cell_flags.h>
#include <tombolo/mesh/cells_of_part.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void VoidCells<dim>::initialize(const PartSetup<dim> &setup)
  {
    nodes = setup.nodes;
    part_cells = setup.part_cells;
    part = setup.index;
    set(std::vector<bool>(cells_of_part(*nodes, *part_cells, part).size(), false));
  }

  template <int dim>
  void VoidCells<dim>::initialize(const PartSetup<dim> &setup, const Predicate<dim> &is_void)
  {
    initialize(setup);
    std::vector<bool> found;
    std::string failure;
    try
    {
      for (const Cell &cell : cells_of_part(*nodes, *part_cells, part))
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
    of_owned = is_void;
    flags.assign(nodes->dof_handler().get_triangulation().n_active_cells(), false);
    std::size_t c = 0;
    for (const Cell &cell : cells_of_part(*nodes, *part_cells, part))
      flags[cell->active_cell_index()] = is_void[c++];
    update_ghost_flags(*nodes, flags);
  }

  template class VoidCells<2>;
  template class VoidCells<3>;
} // namespace tombolo
