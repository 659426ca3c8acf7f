// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>

#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <vector>

namespace tombolo
{
  /**
   * The matrix diag(@p diagonal) + @p factor K + @p averaging L with the conduction of the scene
   * without smoothing, K_IJ = Σ_q V_q k_q ∇N_I(x_q)·∇N_J(x_q): over the particles with their shape
   * functions, over the quadrature points of elements with theirs (of degree 1; those of higher
   * degree count as that many cells between neighbouring nodes), in the present positions and with
   * the conductivities at
   * @p field (node_stride, current ghosts). Where smoothing is `none`, elements have degree 1 and
   * there is no trace bridge, it is that of ThermalModel::apply_conduction() without films. L is
   * the capacity of what averaging over the particles removes, diag(Φᵀc) - Φᵀ diag(c) Φ. Rows and
   * columns of nodes with prescribed temperatures, and of nodes that hang on faces of elements, are
   * those of the unit matrix; what hanging nodes conduct counts at those between which they lie.
   * @p diagonal is scalar, owned values. Collective.
   */
  template <int dim>
  void assemble_conduction_matrix(const Model<dim> &model, const NodalVector &field, double factor,
                                  double averaging, const NodalVector &diagonal,
                                  dealii::TrilinosWrappers::SparseMatrix &matrix);

  /**
   * Indicators of the sublattices of twice the spacing of each owned node, [sublattice][node]:
   * 2^dim of them. Nodal gradients, differences across a particle, see each one alone, so that a
   * constant on one of them conducts next to nothing. Numbers are carried from cell to cell across
   * faces of this rank. Degree 1.
   */
  template <int dim>
  std::vector<std::vector<bool>> sublattices(const Model<dim> &model);
} // namespace tombolo
