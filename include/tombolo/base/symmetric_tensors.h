// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace tombolo
{
  /** Six components of a symmetric tensor in the order of the state: xx, yy, zz, yz, xz, xy. */
  using SymmetricComponents = std::array<double, 6>;

  /** -tr σ/3 of the stress with these six components, positive in compression. */
  inline double pressure(const double *const stress)
  {
    return -(stress[0] + stress[1] + stress[2]) / 3;
  }

  /** The von Mises stress of the stress with these six components. */
  inline double von_mises_stress(const double *const stress)
  {
    const double a = stress[0] - stress[1], b = stress[1] - stress[2], c = stress[2] - stress[0];
    const double shear = stress[3] * stress[3] + stress[4] * stress[4] + stress[5] * stress[5];
    return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
  }

  /** The principal values, the largest first; NaN where a component is not finite. */
  inline std::array<double, 3> principal_values(const double *const tensor)
  {
    std::array<double, 3> result;
    result.fill(std::numeric_limits<double>::quiet_NaN());
    if (!std::all_of(tensor, tensor + 6, [](const double c) { return std::isfinite(c); }))
      return result;
    SymmetricTensor<2, 3> matrix;
    for (unsigned int d = 0; d < 3; ++d)
    {
      matrix[d][d] = tensor[d];
      matrix[(d + 1) % 3][(d + 2) % 3] = tensor[3 + d];
    }
    // The closed form loses half of the digits where two values are nearly the same.
    const auto pairs = eigenvectors(matrix, SymmetricTensorEigenvectorMethod::jacobi);
    result = {{pairs[0].first, pairs[1].first, pairs[2].first}};
    std::sort(result.begin(), result.end(), std::greater<double>());
    return result;
  }

  /** Hencky's strain ½ ln(F Fᵀ) of the deformation gradient F, in two dimensions that of plane
   * strain; NaN where F is not that of a body (det F <= 0). */
  template <int dim>
  SymmetricComponents logarithmic_strain(const Tensor<2, dim> &deformation_gradient)
  {
    if (!(determinant(deformation_gradient) > 0.) ||
        !std::isfinite(deformation_gradient.norm_square()))
    {
      SymmetricComponents none;
      none.fill(std::numeric_limits<double>::quiet_NaN());
      return none;
    }
    SymmetricTensor<2, 3> left_cauchy_green = unit_symmetric_tensor<3>();
    const Tensor<2, dim> product = deformation_gradient * transpose(deformation_gradient);
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b)
        left_cauchy_green[a][b] = product[a][b];
    SymmetricComponents strain{};
    for (const auto &[value, direction] :
         eigenvectors(left_cauchy_green, SymmetricTensorEigenvectorMethod::jacobi))
      for (unsigned int d = 0; d < 3; ++d)
      {
        const double half_logarithm = 0.5 * std::log(value);
        strain[d] += half_logarithm * direction[d] * direction[d];
        strain[3 + d] += half_logarithm * direction[(d + 1) % 3] * direction[(d + 2) % 3];
      }
    return strain;
  }
} // namespace tombolo
