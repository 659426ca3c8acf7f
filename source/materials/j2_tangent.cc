// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/j2_tangent.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    // As J2Plasticity::internal_variables() has them.
    constexpr unsigned int plastic_strain_variable = 0, plastic_work_variable = 1;

    /** Deviator of the stress of a point, and the square of its effective stress. */
    double find_deviator(const MaterialBatch &batch, const unsigned int i, double (&deviator)[6])
    {
      const double mean = (batch.stress[0][i] + batch.stress[1][i] + batch.stress[2][i]) / 3.;
      double squared = 0.;
      for (unsigned int c = 0; c < 6; ++c)
      {
        deviator[c] = batch.stress[c][i] - (c < 3 ? mean : 0.);
        squared += (c < 3 ? 1.5 : 3.) * deviator[c] * deviator[c];
      }
      return squared;
    }
  } // namespace

  J2Tangent::J2Tangent(const MaterialBatch &batch, const double *const seen_temperature,
                       const double heating)
      : heating(heating), sees_temperature(seen_temperature != nullptr), bulk_moduli(batch.n),
        shear_moduli(batch.n), increment(batch.n), temperature(batch.n),
        temperature_change(batch.n), flow(batch.n), slope(batch.n)
  {
    std::copy_n(batch.internal_variables[plastic_strain_variable], batch.n, increment.begin());
    if (!sees_temperature)
      return;
    const double *const work = batch.internal_variables[plastic_work_variable];
    for (unsigned int i = 0; i < batch.n; ++i)
      temperature[i] = seen_temperature[i] - heating * work[i];
  }

  FlowStressBatch J2Tangent::end_of_step(const MaterialBatch &batch)
  {
    const double *const strain = batch.internal_variables[plastic_strain_variable];
    const double *const work = batch.internal_variables[plastic_work_variable];
    for (unsigned int i = 0; i < batch.n; ++i)
    {
      increment[i] = std::max(strain[i] - increment[i], 0.);
      if (!sees_temperature)
        continue;
      double deviator[6];
      temperature[i] += heating * work[i];
      temperature_change[i] =
          heating * batch.volume_ratio[i] * std::sqrt(find_deviator(batch, i, deviator));
    }
    FlowStressBatch end;
    end.n = batch.n;
    end.inverse_time_increment = batch.time_increment > 0. ? 1. / batch.time_increment : 0.;
    end.plastic_strain = strain;
    end.increment = increment.begin();
    end.temperature = sees_temperature ? temperature.begin() : nullptr;
    end.temperature_change = sees_temperature ? temperature_change.begin() : nullptr;
    end.flow_stress = flow.begin();
    end.slope = slope.begin();
    return end;
  }

  void J2Tangent::find(const MaterialBatch &batch, const MaterialTangent &tangent) const
  {
    for (unsigned int i = 0; i < batch.n; ++i)
    {
      set_elastic_tangent(bulk_moduli[i], shear_moduli[i], i, tangent);
      if (increment[i] > 0.)
        soften(batch, i, tangent);
    }
  }

  void J2Tangent::soften(const MaterialBatch &batch, const unsigned int i,
                         const MaterialTangent &tangent) const
  {
    double s[6];
    const double squared = find_deviator(batch, i, s);
    const double threefold_shear = 3. * shear_moduli[i];
    const double effective = std::sqrt(squared);
    const double kept = effective / (effective + threefold_shear * increment[i]);
    const double less = 2. * shear_moduli[i] * (1. - kept);
    const double factor =
        squared > 0. ? threefold_shear / squared * (slope[i] / (slope[i] + threefold_shear) - kept)
                     : 0.;
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        tangent[6 * row + column][i] +=
            factor * s[row] * (column < 3 ? 1. : 2.) * s[column] -
            less * ((row == column ? 1. : 0.) - (row < 3 && column < 3 ? 1. / 3. : 0.));
  }
} // namespace tombolo
