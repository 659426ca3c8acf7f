// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <cmath>

namespace tombolo
{
  /** The axis of coordinates that is furthest from a direction of length one, made perpendicular to
   * it, with the length one. */
  template <int dim>
  dealii::Tensor<1, dim> direction_across(const dealii::Tensor<1, dim> &direction)
  {
    unsigned int axis = 0;
    for (unsigned int d = 1; d < dim; ++d)
      if (std::abs(direction[d]) < std::abs(direction[axis]))
        axis = d;
    dealii::Tensor<1, dim> result = -direction[axis] * direction;
    result[axis] += 1.;
    return result / result.norm();
  }
} // namespace tombolo
