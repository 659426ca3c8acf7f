// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/void_cells.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /** What smoothed_cells_of() needs of a part, with these void cells if they are on. */
  template <int dim>
  PartSetup<dim> mesh_of_part(const Model<dim> &model, const unsigned int part,
                              const VoidCells<dim> *const voids = nullptr)
  {
    PartSetup<dim> setup;
    setup.index = part;
    setup.nodes = model.nodes.get();
    setup.part_cells = model.part_cells.get();
    setup.void_cells = voids != nullptr && voids->is_on() ? voids : nullptr;
    return setup;
  }
} // namespace tombolo
