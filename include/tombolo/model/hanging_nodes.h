// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/model/part.h>
#include <tombolo/state/node_partition.h>

#include <optional>
#include <vector>

namespace tombolo
{
  /** Refuses a mesh in which the size of cells changes where a formulation does not take it (see
   * GradedCells), with the place of the first such face. Throws InputError. Collective. */
  template <int dim>
  void refuse_unfit_gradings(const Mesh<dim> &mesh, const PartCells<dim> &part_cells,
                             const std::vector<Part<dim>> &parts,
                             const std::vector<Section> &part_sections);

  /** Those that this rank owns of the nodes in the middle of faces and edges of cells which do not
   * follow them. Nothing where no rank has any. Throws InputError where such a node is a particle.
   * Collective. */
  template <int dim>
  std::optional<std::vector<DependentNode>>
  find_hanging_nodes(const Mesh<dim> &mesh, const Nodes<dim> &nodes,
                     const PartCells<dim> &part_cells, const std::vector<Part<dim>> &parts);

  /** Adds the nodes on which some @p dependent_nodes depend. */
  void add_nodes_depended_on(const std::optional<std::vector<DependentNode>> &dependent_nodes,
                             dealii::IndexSet &result);
} // namespace tombolo
