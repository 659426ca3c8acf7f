#pragma once

#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/part_cells.h>

#include <vector>

namespace tombolo
{
  /**
   * Distributes the mesh anew so that all ranks have the same work: a cell of part k counts
   * @p work_of_part[k], in any unit common to the parts (nanoseconds per node and step, say; a cell
   * has as many nodes in every part). The numbers must be positive. Call it after
   * PartCells::check() and before anything is numbered on the mesh. Collective.
   */
  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<double> &work_of_part);
} // namespace tombolo
