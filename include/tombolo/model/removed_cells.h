// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/cell_flags.h>
#include <tombolo/mesh/cells_of_part.h>
#include <tombolo/model/model.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** Which cells are no cells of their parts any more, by the index of active cells, ghosts among
   * them; nothing where no part can lose any. Collective. */
  template <int dim>
  std::vector<bool> removed_cells(const Model<dim> &model)
  {
    std::vector<bool> result;
    if (std::none_of(model.parts.begin(), model.parts.end(),
                     [](const Part<dim> &part) { return part.formulation->can_lose_cells(); }))
      return result;
    result.resize(model.mesh.triangulation.n_active_cells(), false);
    for (unsigned int p = 0; p < model.parts.size(); ++p)
    {
      const auto cells = cells_of_part(*model.nodes, *model.part_cells, p);
      for (unsigned int c = 0; c < model.parts[p].formulation->n_cells(); ++c)
        if (model.parts[p].formulation->is_removed(c))
          result[cells[c]->active_cell_index()] = true;
    }
    update_ghost_flags(*model.nodes, result);
    return result;
  }
} // namespace tombolo
