// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/part.h>

#include <vector>

namespace tombolo
{
  /** Refuses a mesh in which the size of cells changes elsewhere than inside of a part of
   * GradedCells, with the place of the first such face. Throws InputError. Collective. */
  template <int dim>
  void refuse_hanging_nodes(const Mesh<dim> &mesh, const PartCells<dim> &part_cells,
                            const std::vector<Part<dim>> &parts,
                            const std::vector<Section> &part_sections);
} // namespace tombolo
