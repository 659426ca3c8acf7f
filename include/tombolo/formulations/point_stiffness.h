// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/part_points.h>
#include <tombolo/materials/kinematics.h>

#include <cmath>

namespace tombolo
{
  /** The elastic stiffness of points for step estimates: the moduli of their material, or where
   * they have a "bulk modulus" of their own that one instead of the material's. */
  class PointStiffness
  {
  public:
    /** Artificial viscosity counts for a step of @p time_step. */
    explicit PointStiffness(const PartPoints &part, const double time_step = 1.)
        : shear_modulus(part.material().shear_modulus()),
          constant_lambda(part.material().bulk_modulus() - 2. / 3. * shear_modulus),
          inverse_modulus(1. / (part.material().bulk_modulus() + 4. / 3. * shear_modulus)),
          rate_factor(2. / time_step),
          ratio(part.points().component(MaterialPoints::volume_ratio, 0))
    {
      if (const unsigned int field = part.points().find_field("bulk modulus");
          field < part.points().fields().size())
        bulk = part.points().component(field, 0);
      if (part.viscosity().is_on())
        viscosity = part.viscosity().tangent(part.points());
    }

    /** The Kirchhoff stress that a velocity gradient causes per unit time, times the initial
     * volume, of n_lanes points from @p i on: (C + 2/Δt of viscosity) : L. */
    TOMBOLO_ALWAYS_INLINE void find_stress(const std::size_t i, const Matrix3<Lanes> &l,
                                           const Lanes &present_volume, Lanes (&stress)[6]) const
    {
      const Lanes volume = present_volume / load_lanes(ratio + i);
      Lanes lambda = constant_lambda;
      if (bulk != nullptr)
        lambda = load_lanes(bulk + i) * load_lanes(ratio + i) - 2. / 3. * shear_modulus;
      if (viscosity != nullptr)
        lambda += rate_factor * load_lanes(viscosity + i);
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

    /** The speed of longitudinal waves at point @p i over that of the material in the initial
     * state; one if all points have the moduli of the material. */
    double relative_speed(const std::size_t i) const
    {
      return bulk == nullptr
                 ? 1.
                 : std::sqrt(ratio[i] * inverse_modulus * (bulk[i] + 4. / 3. * shear_modulus));
    }

    /** The square of the speed of longitudinal waves, over that of the material in the initial
     * state, of n_lanes cells: the largest of their @p n_points points, which begin with @p first.
     * Where the moduli are constant the density is not: c grows with √J. */
    Lanes squared_speed(const std::size_t first, const unsigned int n_points) const
    {
      Lanes largest = 0.;
      for (std::size_t i = first; i < first + n_points * n_lanes; i += n_lanes)
        largest =
            max(largest, bulk == nullptr ? load_lanes(ratio + i)
                                         : load_lanes(ratio + i) * inverse_modulus *
                                               (load_lanes(bulk + i) + 4. / 3. * shear_modulus));
      return largest;
    }

  private:
    double shear_modulus, constant_lambda, inverse_modulus;
    double rate_factor;
    const double *ratio;
    const double *bulk = nullptr, *viscosity = nullptr;
  };
} // namespace tombolo
