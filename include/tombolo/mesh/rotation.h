// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <cmath>

namespace tombolo
{
  /** The rotation by an angle about a unit vector (Rodrigues' formula). */
  inline dealii::Tensor<2, 3> rotation_matrix(const dealii::Tensor<1, 3> &axis, const double angle)
  {
    dealii::Tensor<2, 3> cross;
    cross[0][1] = -axis[2];
    cross[0][2] = axis[1];
    cross[1][0] = axis[2];
    cross[1][2] = -axis[0];
    cross[2][0] = -axis[1];
    cross[2][1] = axis[0];
    dealii::Tensor<2, 3> result = std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
    for (unsigned int d = 0; d < 3; ++d)
      result[d][d] += 1;
    return result;
  }
} // namespace tombolo
