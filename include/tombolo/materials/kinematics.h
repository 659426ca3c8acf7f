// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>

namespace tombolo
{
  /** A 3×3 matrix of numbers or of Lanes, row-major. */
  template <typename Number>
  struct Matrix3
  {
    Number entry[9];

    Number &operator()(const unsigned int i, const unsigned int j)
    {
      return entry[3 * i + j];
    }
    const Number &operator()(const unsigned int i, const unsigned int j) const
    {
      return entry[3 * i + j];
    }
  };

  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Matrix3<Number> zero_matrix()
  {
    Matrix3<Number> result;
    for (Number &entry : result.entry)
      entry = Number(0.);
    return result;
  }

  /** Of the components xx, yy, zz, yz, xz, xy. */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Matrix3<Number> symmetric_matrix(const Number (&tensor)[6])
  {
    return {{tensor[0], tensor[5], tensor[4], tensor[5], tensor[1], tensor[3], tensor[4], tensor[3],
             tensor[2]}};
  }

  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Matrix3<Number> multiply(const Matrix3<Number> &a, const Matrix3<Number> &b)
  {
    Matrix3<Number> result;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      TOMBOLO_UNROLL
    for (unsigned int j = 0; j < 3; ++j)
      result(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    return result;
  }

  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Number determinant(const Matrix3<Number> &a)
  {
    return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) -
           a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
           a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
  }

  /** The inverse, and through @p det the determinant. */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Matrix3<Number> inverse(const Matrix3<Number> &a, Number &det)
  {
    Matrix3<Number> result;
    result(0, 0) = a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1);
    result(0, 1) = a(0, 2) * a(2, 1) - a(0, 1) * a(2, 2);
    result(0, 2) = a(0, 1) * a(1, 2) - a(0, 2) * a(1, 1);
    result(1, 0) = a(1, 2) * a(2, 0) - a(1, 0) * a(2, 2);
    result(1, 1) = a(0, 0) * a(2, 2) - a(0, 2) * a(2, 0);
    result(1, 2) = a(0, 2) * a(1, 0) - a(0, 0) * a(1, 2);
    result(2, 0) = a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0);
    result(2, 1) = a(0, 1) * a(2, 0) - a(0, 0) * a(2, 1);
    result(2, 2) = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
    det = a(0, 0) * result(0, 0) + a(0, 1) * result(1, 0) + a(0, 2) * result(2, 0);
    const Number factor = Number(1.) / det;
    for (Number &entry : result.entry)
      entry = entry * factor;
    return result;
  }

  /** One step of motion at a point, split for the objective stress update. */
  template <typename Number>
  struct MotionIncrement
  {
    Number strain[6]; ///< Δt D of the middle of the step, turned to its end: xx, yy, zz, yz, xz, xy
    Number spin[3];   ///< axial vector of Δt W at the middle of the step
    Number volume_factor; ///< volume at t_n over volume at t_{n-1}
  };

  /**
   * Splits the increment H = Δt ∂v/∂x_n, the displacement increment differentiated with respect to
   * the positions at its *end*. The gradient at the middle of the step is H (I - H/2)⁻¹, of which a
   * rigid rotation leaves no strain at all, however large (Hughes and Winget 1980). The strain has
   * the directions of the middle; it is turned by half the spin (to first order) to those of the
   * end, as the stress has. Without that the stiffness of a spinning body has an
   * antisymmetric part of first order in the spin, and its shortest waves grow.
   */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE MotionIncrement<Number> motion_increment(const Matrix3<Number> &h)
  {
    Matrix3<Number> to_middle, to_begin;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      TOMBOLO_UNROLL
    for (unsigned int j = 0; j < 3; ++j)
    {
      const Number identity(i == j ? 1. : 0.);
      to_middle(i, j) = identity - Number(0.5) * h(i, j);
      to_begin(i, j) = identity - h(i, j);
    }
    Number det;
    const Matrix3<Number> gradient = multiply(h, inverse(to_middle, det));

    MotionIncrement<Number> result;
    result.spin[0] = Number(0.5) * (gradient(2, 1) - gradient(1, 2));
    result.spin[1] = Number(0.5) * (gradient(0, 2) - gradient(2, 0));
    result.spin[2] = Number(0.5) * (gradient(1, 0) - gradient(0, 1));
    const Number(&w)[3] = result.spin;
    const Number xx = gradient(0, 0), yy = gradient(1, 1), zz = gradient(2, 2);
    const Number yz = Number(0.5) * (gradient(1, 2) + gradient(2, 1));
    const Number xz = Number(0.5) * (gradient(0, 2) + gradient(2, 0));
    const Number xy = Number(0.5) * (gradient(0, 1) + gradient(1, 0));
    result.strain[0] = xx + (w[1] * xz - w[2] * xy);
    result.strain[1] = yy + (w[2] * xy - w[0] * yz);
    result.strain[2] = zz + (w[0] * yz - w[1] * xz);
    result.strain[3] = yz + Number(0.5) * (w[2] * xz - w[1] * xy + w[0] * (yy - zz));
    result.strain[4] = xz + Number(0.5) * (w[0] * xy - w[2] * yz + w[1] * (zz - xx));
    result.strain[5] = xy + Number(0.5) * (w[1] * yz - w[0] * xz + w[2] * (xx - yy));
    result.volume_factor = Number(1.) / determinant(to_begin);
    return result;
  }

  /** The rotation of a step whose spin has this axial vector, R = (I - W/2)⁻¹ (I + W/2). */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE Matrix3<Number> rotation_of(const Number spin[3])
  {
    const Number squared = spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2];
    const Number a = Number(1.) / (Number(1.) + Number(0.25) * squared);
    const Number b = Number(0.5) * a;
    Matrix3<Number> rotation;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      TOMBOLO_UNROLL
    for (unsigned int j = 0; j < 3; ++j)
      rotation(i, j) = b * spin[i] * spin[j];
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
      rotation(i, i) = rotation(i, i) + Number(1.) - b * squared;
    rotation(0, 1) = rotation(0, 1) - a * spin[2];
    rotation(1, 0) = rotation(1, 0) + a * spin[2];
    rotation(0, 2) = rotation(0, 2) + a * spin[1];
    rotation(2, 0) = rotation(2, 0) - a * spin[1];
    rotation(1, 2) = rotation(1, 2) - a * spin[0];
    rotation(2, 1) = rotation(2, 1) + a * spin[0];
    return rotation;
  }

  /** Rotates a symmetric tensor (xx, yy, zz, yz, xz, xy) by rotation_of(spin). */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE void rotate(const Number spin[3], Number tensor[6])
  {
    const Matrix3<Number> rotation = rotation_of(spin);
    Matrix3<Number> half;
    TOMBOLO_UNROLL
    for (unsigned int i = 0; i < 3; ++i)
    {
      half(i, 0) =
          rotation(i, 0) * tensor[0] + rotation(i, 1) * tensor[5] + rotation(i, 2) * tensor[4];
      half(i, 1) =
          rotation(i, 0) * tensor[5] + rotation(i, 1) * tensor[1] + rotation(i, 2) * tensor[3];
      half(i, 2) =
          rotation(i, 0) * tensor[4] + rotation(i, 1) * tensor[3] + rotation(i, 2) * tensor[2];
    }
    constexpr unsigned int row[6] = {0, 1, 2, 1, 0, 0};
    constexpr unsigned int column[6] = {0, 1, 2, 2, 2, 1};
    TOMBOLO_UNROLL
    for (unsigned int c = 0; c < 6; ++c)
      tensor[c] = half(row[c], 0) * rotation(column[c], 0) +
                  half(row[c], 1) * rotation(column[c], 1) +
                  half(row[c], 2) * rotation(column[c], 2);
  }

  /** motion_increment() of @p h, with whose spin @p stress is turned: eq. 19, of the Kirchhoff
   * stress τ = J σ. So the work τ : D per initial volume is the change of ½ τ : C⁻¹ : τ also where
   * volumes change; that of Cauchy's stress is not. */
  template <typename Number>
  TOMBOLO_ALWAYS_INLINE MotionIncrement<Number> rate_increment(const Matrix3<Number> &h,
                                                               Number (&stress)[6])
  {
    const MotionIncrement<Number> result = motion_increment(h);
    rotate(result.spin, stress);
    return result;
  }
} // namespace tombolo
