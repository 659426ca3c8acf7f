// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <cmath>

namespace tombolo
{
  /** The elastic stiffness of points for step estimates: the moduli of their material, or where
   * they have a "bulk modulus" of their own that one in the place of the material's. */
  class PointStiffness
  {
  public:
    PointStiffness(const Material &material, const MaterialPoints &points,
                   const StrainMeasure measure)
        : shear_modulus(material.shear_modulus()),
          constant_lambda(material.bulk_modulus() - 2. / 3. * shear_modulus),
          inverse_modulus(1. / (material.bulk_modulus() + 4. / 3. * shear_modulus)),
          is_kirchhoff(measure == StrainMeasure::logarithmic),
          ratio(points.component(MaterialPoints::volume_ratio, 0))
    {
      if (const unsigned int field = points.find_field("bulk modulus");
          field < points.fields().size())
        bulk = points.component(field, 0);
    }

    /** λ of n_lanes points from @p i on: of Cauchy's stress, or with the logarithmic measure of
     * Kirchhoff's. */
    Lanes lambda(const std::size_t i) const
    {
      if (bulk == nullptr)
        return constant_lambda;
      const Lanes modulus = load_lanes(bulk + i);
      return (is_kirchhoff ? modulus * load_lanes(ratio + i) : modulus) - 2. / 3. * shear_modulus;
    }

    /** @p volume times the stress that a velocity gradient causes per unit time, with this λ. */
    void find_stress(const Matrix3<Lanes> &l, const Lanes &volume, const Lanes &lambda,
                     Lanes (&stress)[6]) const
    {
      const Lanes pressure = lambda * volume * (l(0, 0) + l(1, 1) + l(2, 2));
      const Lanes twice = 2. * shear_modulus * volume;
      const Lanes once = shear_modulus * volume;
      stress[0] = pressure + twice * l(0, 0);
      stress[1] = pressure + twice * l(1, 1);
      stress[2] = pressure + twice * l(2, 2);
      stress[3] = once * (l(1, 2) + l(2, 1));
      stress[4] = once * (l(0, 2) + l(2, 0));
      stress[5] = once * (l(0, 1) + l(1, 0));
    }

    /** Whether all points have the moduli of the material. */
    bool is_constant() const
    {
      return bulk == nullptr;
    }

    /** The speed of longitudinal waves at point @p i over that of the material in the initial
     * state; one if is_constant(). */
    double relative_speed(const std::size_t i) const
    {
      return bulk == nullptr
                 ? 1.
                 : std::sqrt(ratio[i] * inverse_modulus * (bulk[i] + 4. / 3. * shear_modulus));
    }

    /** The square of the speed of longitudinal waves of n_lanes points from @p i on, over that of
     * the material in the initial state. */
    Lanes squared_speed(const std::size_t i) const
    {
      const Lanes volume_ratio = load_lanes(ratio + i);
      return bulk == nullptr ? volume_ratio
                             : volume_ratio * inverse_modulus *
                                   (load_lanes(bulk + i) + 4. / 3. * shear_modulus);
    }

  private:
    double shear_modulus, constant_lambda, inverse_modulus;
    bool is_kirchhoff;
    const double *ratio;
    const double *bulk = nullptr;
  };
} // namespace tombolo
