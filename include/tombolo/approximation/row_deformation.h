// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/state/nodal_vector.h>

namespace tombolo
{
  /** F_I = Σ_J (x_J - x_I) ⊗ ∇φ_J, the deformation since the kernel's reference at the particle of
   * @p row, by itself; ∇φ = 0 of rigid rows gives zero. @p position has current ghosts. */
  template <int dim>
  dealii::Tensor<2, dim> row_deformation(const Stencils &shape, const unsigned int row,
                                         const NodalVector &position)
  {
    dealii::Tensor<2, dim> deformation;
    const double *const own = position.node(shape.particle_node[row]);
    const Stencils::Row entries = shape.row(row);
    for (unsigned int k = 0; k < entries.size; ++k)
    {
      const double *const other = position.node(entries.neighbour[k]);
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          deformation[a][b] += (other[a] - own[a]) * entries.gradient[k * Stencils::n_gradient + b];
    }
    return deformation;
  }
} // namespace tombolo
