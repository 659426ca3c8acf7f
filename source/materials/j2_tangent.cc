// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/j2_plasticity.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    using Numbers = dealii::AlignedVector<double>;

    Numbers copy_of(const double *const values, const unsigned int n)
    {
      Numbers result(n);
      std::copy_n(values, n, result.begin());
      return result;
    }

    /** Takes away what plastic flow takes from the elastic tangent of point @p i. With the trial
     * stress t = q + 3G Δp and dq = H dΔp,
     *
     * @verbatim
     *   ds = (q/t) 2G de + (3G/q²) [H/(H + 3G) - q/t] s (s : de)
     * @endverbatim
     */
    void soften(const MaterialBatch &batch, const unsigned int i, const double shear,
                const double increment, const double slope, const MaterialTangent &tangent)
    {
      const double mean = (batch.stress[0][i] + batch.stress[1][i] + batch.stress[2][i]) / 3.;
      double s[6], squared = 0.;
      for (unsigned int c = 0; c < 6; ++c)
      {
        s[c] = batch.stress[c][i] - (c < 3 ? mean : 0.);
        squared += (c < 3 ? 1.5 : 3.) * s[c] * s[c];
      }
      const double flow = std::sqrt(squared), trial = flow + 3. * shear * increment;
      const double kept = flow / trial;
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
  } // namespace

  void J2Plasticity::update_stress_and_tangent(MaterialBatch &batch,
                                               const MaterialTangent &tangent) const
  {
    constexpr unsigned int plastic_strain = 0, work = 1; // as internal_variables() has them
    const unsigned int n = batch.n;
    const double *const strain = batch.internal_variables[plastic_strain];
    Numbers increment = copy_of(strain, n);
    Numbers new_temperature(n), temperature_change(n), slope(n), flow(n), bulk(n), shear(n);
    if (sees_temperature)
    {
      std::copy_n(temperature_of(batch), n, new_temperature.begin());
      for (unsigned int i = 0; i < n; ++i)
        new_temperature[i] -= heating * batch.internal_variables[work][i];
    }
    elastic_moduli(n, batch.temperature, bulk.begin(), shear.begin());
    update_stress(batch);

    for (unsigned int i = 0; i < n; ++i)
    {
      increment[i] = std::max(strain[i] - increment[i], 0.);
      set_elastic_tangent(bulk[i], shear[i], i, tangent);
      if (!sees_temperature)
        continue;
      new_temperature[i] += heating * batch.internal_variables[work][i];
      double squared = 0.;
      for (unsigned int c = 0; c < 3; ++c)
      {
        const double difference = batch.stress[c][i] - batch.stress[(c + 1) % 3][i];
        squared +=
            0.5 * difference * difference + 3. * batch.stress[3 + c][i] * batch.stress[3 + c][i];
      }
      temperature_change[i] = heating * batch.volume_ratio[i] * std::sqrt(squared);
    }
    FlowStressBatch end;
    end.n = n;
    end.inverse_time_increment = batch.time_increment > 0. ? 1. / batch.time_increment : 0.;
    end.plastic_strain = strain;
    end.increment = increment.begin();
    end.temperature = sees_temperature ? new_temperature.begin() : nullptr;
    end.temperature_change = sees_temperature ? temperature_change.begin() : nullptr;
    end.flow_stress = flow.begin();
    end.slope = slope.begin();
    flow_stress->evaluate(end);
    for (unsigned int i = 0; i < n; ++i)
      if (increment[i] > 0.)
        soften(batch, i, shear[i], increment[i], slope[i], tangent);
  }
} // namespace tombolo
