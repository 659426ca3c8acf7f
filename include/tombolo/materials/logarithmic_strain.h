// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/kinematics.h>

#include <cmath>

namespace tombolo
{
  /** What makes the strain of a Kirchhoff stress by an isotropic elastic law [L T^2/M]. */
  struct Compliance
  {
    Compliance() = default;
    Compliance(const Lanes &bulk_modulus, const Lanes &shear_modulus)
        : deviatoric(0.5 / shear_modulus), volumetric(1. / (3. * bulk_modulus))
    {}

    Lanes deviatoric; ///< 1/(2G), of the deviator
    Lanes volumetric; ///< 1/(3K), of the mean stress
  };

  /**
   * The logarithmic counterpart of motion_increment(): with the elastic logarithmic strain ε at
   * t_{n-1}, ½ ln b_e, and the deformation of the step f = (I - H)⁻¹, that of a purely elastic step
   * is ε' = ½ ln(f exp(2ε) fᵀ) = -½ ln((I - H)ᵀ exp(-2ε) (I - H)). The strain of the result is
   * ε' - R ε Rᵀ, with the rotation R of its spin: for an isotropic elastic law the rotated stress
   * and the increment that it causes are the stress of ε', a function of the deformation alone. In
   * a closed cycle without plastic flow no work is left, and with H of the positions' own gradients
   * the forces are the derivative of an energy (Simo 1992, with the exponential map).
   *
   * @p h is H as in motion_increment(); @p stress, Kirchhoff's of the components xx, yy, zz, yz,
   * xz, xy, is that of ε and is turned by R.
   */
  MotionIncrement<Lanes> logarithmic_increment(const Matrix3<Lanes> &h,
                                               const Compliance &compliance, Lanes (&stress)[6]);

  /** ε of the Kirchhoff stress. */
  TOMBOLO_ALWAYS_INLINE void elastic_strain_of(const Lanes (&kirchhoff_stress)[6],
                                               const Compliance &compliance, Lanes (&strain)[6])
  {
    const Lanes mean =
        (kirchhoff_stress[0] + kirchhoff_stress[1] + kirchhoff_stress[2]) * (1. / 3.);
    for (unsigned int c = 0; c < 6; ++c)
      strain[c] = c < 3 ? (kirchhoff_stress[c] - mean) * compliance.deviatoric +
                              mean * compliance.volumetric
                        : kirchhoff_stress[c] * compliance.deviatoric;
  }

  /** Arguments up to which the short series below have all digits. */
  constexpr double largest_of_short_series = 0.003;

  /** exp(x) - 1, with all digits of a small x. */
  TOMBOLO_ALWAYS_INLINE Lanes exponential_less_one(const Lanes &x)
  {
    Lanes result = x * (1. + x * (0.5 + x * (1. / 6. + x * (1. / 24. + x * (1. / 120.)))));
    const LaneMask is_large = !(abs(x) < largest_of_short_series);
    if (any_of(is_large))
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        if (is_large[lane])
          result[lane] = std::expm1(x[lane]);
    return result;
  }

  /** ln(1 + x), with all digits of a small x. */
  TOMBOLO_ALWAYS_INLINE Lanes logarithm_of_one_and(const Lanes &x)
  {
    Lanes result = x * (1. - x * (0.5 - x * (1. / 3. - x * (0.25 - x * (0.2 - x * (1. / 6.))))));
    const LaneMask is_large = !(abs(x) < largest_of_short_series);
    if (any_of(is_large))
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        if (is_large[lane])
          result[lane] = std::log1p(x[lane]);
    return result;
  }
} // namespace tombolo
