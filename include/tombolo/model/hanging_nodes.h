// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/model/part.h>

#include <vector>

namespace tombolo
{
  /** Refuses a mesh in which the size of cells changes where a formulation does not take it (see
   * MiddleNodes), with the place of the first such face. Throws InputError. Collective. */
  template <int dim>
  void refuse_unfit_gradings(const Mesh<dim> &mesh, const PartCells<dim> &part_cells,
                             const std::vector<Part<dim>> &parts,
                             const std::vector<Section> &part_sections);

  /** The nodes in the middle of faces and edges of cells where these are means, ascending: as far
   * as this rank sees cells, so all around nodes that it owns. */
  template <int dim>
  std::vector<DependentNode> find_hanging_nodes(const Nodes<dim> &nodes,
                                                const PartCells<dim> &part_cells,
                                                const std::vector<Part<dim>> &parts);
} // namespace tombolo
