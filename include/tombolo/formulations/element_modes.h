#pragma once

#include <tombolo/base/unroll.h>
#include <tombolo/base/vectorization.h>

namespace tombolo
{
  /**
   * A multilinear field on a cell by its modes: mode m is the product of the reference coordinates
   * ξ_d ∈ [-1, 1] of the bits d that are set in m (in three dimensions 0: 1, 1: ξ, 2: η, 4: ζ,
   * 3: ξη, 5: ξζ, 6: ηζ, 7: ξηζ). Nodes are numbered in the same way: bit d of the number of a node
   * tells whether ξ_d is +1 there. Both directions are fast Walsh-Hadamard transforms: dim·2^dim
   * additions for what would be 4^dim products, and all geometry is shorter in modes.
   */

  /** Replaces nodal values by 2^dim times the coefficients of the modes; the sums that turn shape
   * function coefficients into modes, too. */
  template <unsigned int n_nodes>
  inline void sum_to_modes(Lanes (&values)[n_nodes])
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
  inline void expand_to_nodes(Lanes (&modes)[n_nodes])
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

  /** Whether a mode is the product of two or more coordinates: those that a mean gradient does not
   * see. */
  constexpr bool is_hourglass_mode(const unsigned int mode)
  {
    return (mode & (mode - 1)) != 0;
  }

  /** result = a × b */
  inline void cross(const Lanes (&a)[3], const Lanes (&b)[3], Lanes (&result)[3])
  {
    result[0] = a[1] * b[2] - a[2] * b[1];
    result[1] = a[2] * b[0] - a[0] * b[2];
    result[2] = a[0] * b[1] - a[1] * b[0];
  }

  /**
   * The volume of a cell with multilinear geometry and its derivative with respect to the modes of
   * the positions, which is the integral of the gradients of the modes: exact, in closed form (the
   * uniform gradient of Flanagan and Belytschko 1981). @p modes and @p gradient are [mode][d]; the
   * first and the last mode have none and are neither read nor written. With x = Σ_m X_m ξ^m,
   * V/8 = [X1, X2, X4] + ([X1, X3, X5] + [X3, X2, X6] + [X5, X6, X4]) / 3.
   */
  inline void volume_gradient(const Lanes (&modes)[8][3], Lanes (&gradient)[8][3], Lanes &volume)
  {
    // ∂V/∂X_result = 8 (X_a × X_b + X_c × X_d / 3)
    const auto edge = [&](const unsigned int result, const unsigned int a, const unsigned int b,
                          const unsigned int c, const unsigned int d)
    {
      Lanes main[3], correction[3];
      cross(modes[a], modes[b], main);
      cross(modes[c], modes[d], correction);
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 3; ++i)
        gradient[result][i] = 8. * main[i] + (8. / 3.) * correction[i];
    };
    // ∂V/∂X_result = 8/3 (X_a × X_b + X_c × X_d)
    const auto diagonal = [&](const unsigned int result, const unsigned int a, const unsigned int b,
                              const unsigned int c, const unsigned int d)
    {
      Lanes first[3], second[3];
      cross(modes[a], modes[b], first);
      cross(modes[c], modes[d], second);
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 3; ++i)
        gradient[result][i] = (8. / 3.) * (first[i] + second[i]);
    };
    edge(1, 2, 4, 3, 5);
    edge(2, 4, 1, 6, 3);
    edge(4, 1, 2, 5, 6);
    diagonal(3, 5, 1, 2, 6);
    diagonal(6, 3, 2, 4, 5);
    diagonal(5, 6, 4, 1, 3);
    volume = 0.;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      volume += modes[1][i] * gradient[1][i] + modes[6][i] * gradient[6][i];
  }

  /** The same for a quadrilateral: V/4 = X1 × X2. */
  inline void volume_gradient(const Lanes (&modes)[4][2], Lanes (&gradient)[4][2], Lanes &volume)
  {
    gradient[1][0] = 4. * modes[2][1];
    gradient[1][1] = -4. * modes[2][0];
    gradient[2][0] = -4. * modes[1][1];
    gradient[2][1] = 4. * modes[1][0];
    volume = modes[1][0] * gradient[1][0] + modes[1][1] * gradient[1][1];
  }
} // namespace tombolo
