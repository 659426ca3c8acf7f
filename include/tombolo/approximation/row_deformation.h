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
    const NodeLanes own = load_node(position.node(shape.particle_node[row]));
    const Stencils::Row entries = shape.row_of_gradients(row);
    NodeLanes columns[dim];
    for (unsigned int b = 0; b < dim; ++b)
      columns[b] = 0.;
    for (unsigned int k = 0; k < entries.size; ++k)
    {
      const NodeLanes offset = load_node(position.node(entries.neighbour[k])) - own;
      for (unsigned int b = 0; b < dim; ++b)
        columns[b] += offset * entries.gradient[k * Stencils::n_gradient + b];
    }
    dealii::Tensor<2, dim> deformation;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        deformation[a][b] = columns[b][a];
    return deformation;
  }

  /** √Σ_J |F⁻ᵀ∇φ_J|² of @p row at @p position (current ghosts) [1/L]; infinite for det F <= 0. */
  template <int dim>
  double present_gradient(const Stencils &shape, const unsigned int row,
                          const NodalVector &position)
  {
    const Stencils::Row stencil = shape.row_of_gradients(row);
    const NodeLanes own = load_node(position.node(shape.particle_node[row]));
    NodeLanes deformation[dim], moment[dim]; // F and Σ_J ∇φ_J ⊗ ∇φ_J, by columns
    for (unsigned int b = 0; b < dim; ++b)
      deformation[b] = moment[b] = 0.;
    for (unsigned int k = 0; k < stencil.size; ++k)
    {
      const double *const gradient = stencil.gradient + k * Stencils::n_gradient;
      const NodeLanes all = load_node(gradient),
                      offset = load_node(position.node(stencil.neighbour[k])) - own;
      for (unsigned int b = 0; b < dim; ++b)
      {
        deformation[b] += offset * gradient[b];
        moment[b] += all * gradient[b];
      }
    }
    dealii::Tensor<2, dim> deformation_gradient;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        deformation_gradient[a][b] = deformation[b][a];
    if (!(determinant(deformation_gradient) > 0.))
      return std::numeric_limits<double>::infinity();
    const dealii::Tensor<2, dim> inverse = invert(deformation_gradient);
    double squared = 0;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        for (unsigned int c = 0; c < dim; ++c)
          squared += inverse[b][a] * inverse[c][a] * moment[b][c];
    return std::sqrt(squared);
  }

  /** F⁻¹ of @p row, where it is current. */
  template <int dim>
  dealii::Tensor<2, dim> inverse_row_deformation(const Stencils &shape, const unsigned int row)
  {
    const double *const rows =
        shape.inverse_deformation.data() + 3 * node_stride * std::size_t(row);
    dealii::Tensor<2, dim> inverse;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        inverse[a][b] = rows[a * node_stride + b];
    return inverse;
  }

  /** √Σ_J |∇φ_J|² of @p row, by the gradients in the reference [1/L]. */
  template <int dim>
  double gradient_of_reference(const Stencils &shape, const unsigned int row)
  {
    const Stencils::Row stencil = shape.row_of_gradients(row);
    double squared = 0;
    for (unsigned int k = 0; k < stencil.size; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        squared += stencil.gradient[k * Stencils::n_gradient + d] *
                   stencil.gradient[k * Stencils::n_gradient + d];
    return std::sqrt(squared);
  }

  /** Whether present_gradient() of @p row is not at most @p largest. @p reference_gradient is
   * gradient_of_reference() of it; F⁻¹ of the row is taken where it is current. */
  template <int dim>
  bool exceeds_gradient(const Stencils &shape, const unsigned int row, const NodalVector &position,
                        const double reference_gradient, const double largest)
  {
    if (shape.inverse_deformation_is_current)
    {
      // √Σ |F⁻ᵀ∇φ|² is at most |F⁻¹| √Σ |∇φ|², which mostly suffices, but not at the limit.
      constexpr double margin = 0.99;
      const dealii::Tensor<2, dim> inverse = inverse_row_deformation<dim>(shape, row);
      if (determinant(inverse) > 0. && inverse.norm() * reference_gradient <= margin * largest)
        return false;
    }
    return !(present_gradient<dim>(shape, row, position) <= largest);
  }
} // namespace tombolo
