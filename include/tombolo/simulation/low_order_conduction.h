#pragma once

#include <tombolo/simulation/scene.h>

#include <deal.II/lac/trilinos_sparse_matrix.h>

namespace tombolo
{
  /** The matrix diag(@p diagonal) + @p factor K with the conduction K of multilinear finite
   * elements between neighbouring nodes of all cells, particle cells too, in the present positions
   * and at the initial conductivities. Rows and columns of nodes with prescribed temperatures are
   * those of the unit matrix. For preconditioning. Collective. */
  template <int dim>
  void assemble_low_order_conduction(const Scene<dim> &scene, double factor,
                                     const NodalVector &diagonal,
                                     dealii::TrilinosWrappers::SparseMatrix &matrix);
} // namespace tombolo
