// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  /** The inverse of a 3×3 matrix; returns the determinant. */
  TOMBOLO_ALWAYS_INLINE Lanes invert(const Lanes (&a)[3][3], Lanes (&inverse)[3][3])
  {
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
      {
        const unsigned int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        inverse[j][i] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
      }
    const Lanes determinant =
        a[0][0] * inverse[0][0] + a[0][1] * inverse[1][0] + a[0][2] * inverse[2][0];
    const Lanes factor = 1. / determinant;
    for (auto &row : inverse)
      for (Lanes &entry : row)
        entry *= factor;
    return determinant;
  }

  /** The inverse of a 2×2 matrix; returns the determinant. */
  TOMBOLO_ALWAYS_INLINE Lanes invert(const Lanes (&a)[2][2], Lanes (&inverse)[2][2])
  {
    const Lanes determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    const Lanes factor = 1. / determinant;
    inverse[0][0] = a[1][1] * factor;
    inverse[0][1] = -a[0][1] * factor;
    inverse[1][0] = -a[1][0] * factor;
    inverse[1][1] = a[0][0] * factor;
    return determinant;
  }
} // namespace tombolo
