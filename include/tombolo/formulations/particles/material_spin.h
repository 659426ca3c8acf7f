// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/state/nodal_vector.h>

#include <array>

namespace tombolo
{
  /** ω × r; in two dimensions ω is along z. */
  template <int dim>
  dealii::Tensor<1, dim> cross_product(const double *const axial, const dealii::Tensor<1, dim> &r)
  {
    dealii::Tensor<1, dim> result;
    if constexpr (dim == 2)
    {
      result[0] = -axial[2] * r[1];
      result[1] = axial[2] * r[0];
    }
    else
      for (unsigned int d = 0; d < dim; ++d)
      {
        const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
        result[d] = axial[e] * r[f] - axial[f] * r[e];
      }
    return result;
  }

  template <int dim>
  dealii::Tensor<1, dim> components_at(const NodalVector &vector, const unsigned int node)
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = vector.node(node)[d];
    return result;
  }

  /** g = F⁻ᵀ∇φ of entry @p k. */
  template <int dim>
  dealii::Tensor<1, dim> gradient_at_present(const Stencils::Row &row, const unsigned int k,
                                             const dealii::Tensor<2, dim> &inverse)
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        result[a] += inverse[b][a] * row.gradient[k * Stencils::n_gradient + b];
    return result;
  }

  /** The axial vector of the skew part of Σ_K (Δu_K - Δu_I) ⊗ g_K. */
  template <int dim>
  std::array<double, 3> spin_of_row(const Stencils &shape, const unsigned int i,
                                    const dealii::Tensor<2, dim> &inverse,
                                    const NodalVector &displacement)
  {
    const Stencils::Row row = shape.row(i);
    const auto own = components_at<dim>(displacement, shape.particle_node[i]);
    dealii::Tensor<2, dim> gradient;
    for (unsigned int k = 0; k < row.size; ++k)
      gradient += outer_product(components_at<dim>(displacement, row.neighbour[k]) - own,
                                gradient_at_present<dim>(row, k, inverse));
    std::array<double, 3> axial{};
    axial[2] = 0.5 * (gradient[1][0] - gradient[0][1]);
    if constexpr (dim == 3)
    {
      axial[0] = 0.5 * (gradient[2][1] - gradient[1][2]);
      axial[1] = 0.5 * (gradient[0][2] - gradient[2][0]);
    }
    return axial;
  }
} // namespace tombolo
