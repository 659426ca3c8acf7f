// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/nodal_vector.h>

#include <cmath>
#include <limits>

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

  /** √Σ_J |F⁻ᵀ∇φ_J|² of @p row, by the gradients in the present configuration [1/L]; infinite where
   * F is not that of a body. @p position has current ghosts. */
  template <int dim>
  double present_gradient(const Stencils &shape, const unsigned int row,
                          const NodalVector &position)
  {
    const Stencils::Row of_row = shape.row(row);
    const NodeLanes own = load_node(position.node(shape.particle_node[row]));
    NodeLanes deformation[dim], moment[dim]; // F and Σ_J ∇φ_J ⊗ ∇φ_J, by columns
    for (unsigned int b = 0; b < dim; ++b)
      deformation[b] = moment[b] = 0.;
    for (unsigned int k = 0; k < of_row.size; ++k)
    {
      const double *const gradient = of_row.gradient + k * Stencils::n_gradient;
      const NodeLanes all = load_node(gradient),
                      offset = load_node(position.node(of_row.neighbour[k])) - own;
      for (unsigned int b = 0; b < dim; ++b)
      {
        deformation[b] += offset * gradient[b];
        moment[b] += all * gradient[b];
      }
    }
    dealii::Tensor<2, dim> of_columns;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        of_columns[a][b] = deformation[b][a];
    if (!(determinant(of_columns) > 0.))
      return std::numeric_limits<double>::infinity();
    const dealii::Tensor<2, dim> inverse = invert(of_columns);
    double squared = 0;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        for (unsigned int c = 0; c < dim; ++c)
          squared += inverse[b][a] * inverse[c][a] * moment[b][c];
    return std::sqrt(squared);
  }
} // namespace tombolo
