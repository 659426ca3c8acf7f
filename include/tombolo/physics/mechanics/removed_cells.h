// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Which cells are gone, by the index of active cells, ghosts among them; nothing where no part
   * can lose any. Cells that became particles are not gone. Collective. */
  template <int dim>
  std::vector<bool> removed_cells(const Model<dim> &model)
  {
    std::vector<bool> result;
    if (std::none_of(model.parts.begin(), model.parts.end(),
                     [](const Part<dim> &part) { return part.formulation->can_lose_cells(); }))
      return result;
    result.resize(model.mesh.triangulation.n_active_cells(), false);
    std::vector<dealii::types::global_dof_index> numbers;
    for (unsigned int p = 0; p < model.parts.size(); ++p)
    {
      if (!model.parts[p].formulation->can_lose_cells())
        continue;
      const NodalVector particles =
          marked_nodes(model.state.partition(),
                       [&](const auto &mark)
                       {
                         for (const Part<dim> &other : model.parts)
                           if (other.source == p)
                             std::for_each(other.formulation->particle_nodes().begin(),
                                           other.formulation->particle_nodes().end(), mark);
                       });
      const auto cells = cells_of_part(*model.nodes, *model.part_cells, p);
      for (unsigned int c = 0; c < model.parts[p].formulation->n_cells(); ++c)
      {
        if (!model.parts[p].formulation->is_removed(c))
          continue;
        model.nodes->cell_nodes(cells[c], numbers);
        result[cells[c]->active_cell_index()] =
            std::any_of(numbers.begin(), numbers.end(),
                        [&](const dealii::types::global_dof_index node) {
                          return *particles.node(model.state.partition()->local_index(node)) == 0.;
                        });
      }
    }
    update_ghost_flags(*model.nodes, result);
    return result;
  }

  /** Sets @p former to removed_cells(). Returns whether it was another on any rank. Collective. */
  template <int dim>
  bool removed_cells_differ(const Model<dim> &model, std::vector<bool> &former)
  {
    const std::vector<bool> before = std::exchange(former, removed_cells(model));
    return dealii::Utilities::MPI::max(before == former ? 0 : 1, model.communicator) == 1;
  }
} // namespace tombolo
