// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/material.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  /**
   * The consistent tangent of a radial return to a flow stress: made before the stress of a batch
   * is updated, it finds the tangent after that. With the trial stress t = q + 3G Δp, dq = H dΔp,
   *
   * @verbatim
   *   ds = (q/t) 2G de + (3G/q²) [H/(H + 3G) - q/t] s (s : de)
   * @endverbatim
   *
   * where s is the deviator of the stress, q its von Mises stress, Δp the plastic increment.
   */
  class RadialReturnTangent
  {
  public:
    /** Keeps the plastic strain, the first internal variable of @p batch. @p temperature is that
     * of the flow stress at the start of the step without the heating of its end, null where it
     * has none. @p heating is the temperature per plastic work, which is the second variable. */
    RadialReturnTangent(const MaterialBatch &batch, const double *const temperature,
                        const double heating)
        : increment(batch.n), slope(batch.n), heating(heating)
    {
      std::copy_n(batch.internal_variables[plastic_strain_variable], batch.n, increment.begin());
      if (temperature == nullptr)
        return;
      temperature_without_own.resize(batch.n);
      for (unsigned int i = 0; i < batch.n; ++i)
        temperature_without_own[i] =
            temperature[i] - heating * batch.internal_variables[plastic_work_variable][i];
    }

    /** Sets @p tangent after update_stress(), by the moduli at each point [M/(L T^2)]. */
    void find(const MaterialBatch &batch, const FlowStress &flow_stress, const double *const bulk,
              const double *const shear, const MaterialTangent &tangent)
    {
      const double *const strain = batch.internal_variables[plastic_strain_variable];
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        increment[i] = std::max(strain[i] - increment[i], 0.);
        set_elastic_tangent(bulk[i], shear[i], i, tangent);
      }
      evaluate_slope(batch, flow_stress);
      for (unsigned int i = 0; i < batch.n; ++i)
        if (increment[i] > 0.)
          soften(batch, i, shear[i], increment[i], slope[i], tangent);
    }

  private:
    // As the internal variables of the material have them.
    static constexpr unsigned int plastic_strain_variable = 0, plastic_work_variable = 1;

    /** The deviator of the stress of point @p i; returns the square of its von Mises stress. */
    static double deviator_of(const MaterialBatch &batch, const unsigned int i, double (&s)[6])
    {
      const double mean = (batch.stress[0][i] + batch.stress[1][i] + batch.stress[2][i]) / 3.;
      double squared = 0.;
      for (unsigned int c = 0; c < 6; ++c)
      {
        s[c] = batch.stress[c][i] - (c < 3 ? mean : 0.);
        squared += (c < 3 ? 1.5 : 3.) * s[c] * s[c];
      }
      return squared;
    }

    /** Subtracts the share of plastic flow from the elastic tangent of point @p i. */
    static void soften(const MaterialBatch &batch, const unsigned int i, const double shear,
                       const double increment, const double slope, const MaterialTangent &tangent)
    {
      constexpr double round_off = 1e-12;
      double s[6];
      const double squared = deviator_of(batch, i, s);
      const double flow = std::sqrt(squared), trial = flow + 3. * shear * increment;
      const double kept = flow / trial;
      // Whether a point on the yield surface flows depends on its last digit. Unloading begins
      // there, and must not begin without the elastic stiffness.
      if (1. - kept <= round_off)
        return;
      for (unsigned int row = 0; row < 6; ++row)
        for (unsigned int column = 0; column < 6; ++column)
          tangent[6 * row + column][i] -=
              2. * shear * (1. - kept) *
              ((row == column ? 1. : 0.) - (row < 3 && column < 3 ? 1. / 3. : 0.));
      if (!(flow > 0.))
        return;
      const double factor = 3. * shear / squared * (slope / (slope + 3. * shear) - kept);
      for (unsigned int row = 0; row < 6; ++row)
        for (unsigned int column = 0; column < 6; ++column)
          tangent[6 * row + column][i] += factor * s[row] * (column < 3 ? 1. : 2.) * s[column];
    }

    using Numbers = dealii::AlignedVector<double>;

    void evaluate_slope(const MaterialBatch &batch, const FlowStress &flow_stress)
    {
      const bool has_temperature = !temperature_without_own.empty();
      Numbers flow(batch.n), temperature(batch.n), temperature_change(batch.n);
      for (unsigned int i = 0; has_temperature && i < batch.n; ++i)
      {
        double s[6];
        temperature[i] = temperature_without_own[i] +
                         heating * batch.internal_variables[plastic_work_variable][i];
        temperature_change[i] = heating * std::sqrt(deviator_of(batch, i, s));
      }
      flow_stress.evaluate({batch.n, batch.time_increment > 0. ? 1. / batch.time_increment : 0.,
                            batch.internal_variables[plastic_strain_variable], increment.begin(),
                            has_temperature ? temperature.begin() : nullptr,
                            has_temperature ? temperature_change.begin() : nullptr, flow.begin(),
                            slope.begin()});
    }

    Numbers increment;               // first the old plastic strain
    Numbers temperature_without_own; // without the plastic heating of the step; empty: not used
    Numbers slope;                   // H [M/(L T^2)]
    double heating;
  };
} // namespace tombolo
