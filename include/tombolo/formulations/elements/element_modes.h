// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  /**
   * A multilinear field on a cell by its modes: mode m is the product of the reference coordinates
   * ξ_d ∈ [-1, 1] of the bits d that are set in m (in three dimensions 0: 1, 1: ξ, 2: η, 4: ζ,
   * 3: ξη, 5: ξζ, 6: ηζ, 7: ξηζ). Nodes are numbered in the same way: bit d of the number of a node
   * is set where ξ_d is +1. Both directions are fast Walsh-Hadamard transforms: dim·2^dim
   * additions for what would be 4^dim products, and all geometry is shorter in modes.
   */

  /** Replaces nodal values by 2^dim times the coefficients of the modes; the sums that turn shape
   * function coefficients into modes, too. */
  template <unsigned int n_nodes>
  TOMBOLO_ALWAYS_INLINE void sum_to_modes(Lanes (&values)[n_nodes])
  {
    TOMBOLO_UNROLL
    for (unsigned int bit = 1; bit < n_nodes; bit *= 2)
      TOMBOLO_UNROLL
    for (unsigned int i = 0; i < n_nodes; ++i)
      if ((i & bit) == 0)
      {
        const Lanes sum = values[i] + values[i | bit];
        values[i | bit] = values[i | bit] - values[i];
        values[i] = sum;
      }
  }

  /** The transpose of sum_to_modes(): values of the modes' sum at the nodes. */
  template <unsigned int n_nodes>
  TOMBOLO_ALWAYS_INLINE void expand_to_nodes(Lanes (&modes)[n_nodes])
  {
    TOMBOLO_UNROLL
    for (unsigned int bit = 1; bit < n_nodes; bit *= 2)
      TOMBOLO_UNROLL
    for (unsigned int i = 0; i < n_nodes; ++i)
      if ((i & bit) == 0)
      {
        const Lanes lower = modes[i] - modes[i | bit];
        modes[i | bit] = modes[i] + modes[i | bit];
        modes[i] = lower;
      }
  }

  /** Whether a mode is a product of several coordinates, which does not change a mean gradient. */
  constexpr bool is_hourglass_mode(const unsigned int mode)
  {
    return (mode & (mode - 1)) != 0;
  }

  /** result = p a × b + q c × d */
  TOMBOLO_ALWAYS_INLINE void add_crosses(const double p, const Lanes (&a)[3], const Lanes (&b)[3],
                                         const double q, const Lanes (&c)[3], const Lanes (&d)[3],
                                         Lanes (&result)[3])
  {
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
    {
      const unsigned int j = (i + 1) % 3, k = (i + 2) % 3;
      result[i] = p * (a[j] * b[k] - a[k] * b[j]) + q * (c[j] * d[k] - c[k] * d[j]);
    }
  }

  /**
   * The volume of a cell with multilinear geometry and its derivative with respect to the modes of
   * the positions, which is the integral of the gradients of the modes: exact, in closed form (the
   * uniform gradient of Flanagan and Belytschko 1981). @p modes and @p gradient are [mode][d]; the
   * first and the last mode have none and are neither read nor written. With x = Σ_m X_m ξ^m,
   * V/8 = [X1, X2, X4] + ([X1, X3, X5] + [X3, X2, X6] + [X5, X6, X4]) / 3.
   */
  TOMBOLO_ALWAYS_INLINE void volume_gradient(const Lanes (&modes)[8][3], Lanes (&gradient)[8][3],
                                             Lanes &volume)
  {
    constexpr double third = 8. / 3.;
    add_crosses(8., modes[2], modes[4], third, modes[3], modes[5], gradient[1]);
    add_crosses(8., modes[4], modes[1], third, modes[6], modes[3], gradient[2]);
    add_crosses(8., modes[1], modes[2], third, modes[5], modes[6], gradient[4]);
    add_crosses(third, modes[5], modes[1], third, modes[2], modes[6], gradient[3]);
    add_crosses(third, modes[3], modes[2], third, modes[4], modes[5], gradient[6]);
    add_crosses(third, modes[6], modes[4], third, modes[1], modes[3], gradient[5]);
    volume = 0.;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      volume += modes[1][i] * gradient[1][i] + modes[6][i] * gradient[6][i];
  }

  /** The same for a quadrilateral: V/4 = X1 × X2. */
  TOMBOLO_ALWAYS_INLINE void volume_gradient(const Lanes (&modes)[4][2], Lanes (&gradient)[4][2],
                                             Lanes &volume)
  {
    gradient[1][0] = 4. * modes[2][1];
    gradient[1][1] = -4. * modes[2][0];
    gradient[2][0] = -4. * modes[1][1];
    gradient[2][1] = 4. * modes[1][0];
    volume = modes[1][0] * gradient[1][0] + modes[1][1] * gradient[1][1];
  }

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
