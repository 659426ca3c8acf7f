// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/part_cells.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /**
   * Distributes the mesh anew so that all ranks have the same work: a cell of part k counts
   * @p work_of_part[k](box_ratio), a positive number of relative cost units, where the box along
   * the axes around the cell has box_ratio times its volume. Call it after PartCells::check() and
   * before anything is numbered on the mesh. Collective.
   */
  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<std::function<double(double)>> &work_of_part);
} // namespace tombolo
