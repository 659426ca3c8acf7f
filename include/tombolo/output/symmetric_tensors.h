// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <array>

namespace tombolo
{
  /** Six components of a symmetric tensor in the order of the state: xx, yy, zz, yz, xz, xy. */
  using SymmetricComponents = std::array<double, 6>;

  /** -tr σ/3 of the stress with these six components, positive in compression. */
  double pressure(const double *stress);

  /** The von Mises stress of the stress with these six components. */
  double von_mises_stress(const double *stress);

  /** The principal values of the tensor with these six components, the largest first; NaN where one
   * of them is not finite. */
  std::array<double, 3> principal_values(const double *tensor);

  /** Hencky's strain ½ ln(F Fᵀ) of the deformation gradient F, in two dimensions that of plane
   * strain; NaN where F is not that of a body (det F <= 0). */
  template <int dim>
  SymmetricComponents logarithmic_strain(const dealii::Tensor<2, dim> &deformation_gradient);
} // namespace tombolo
