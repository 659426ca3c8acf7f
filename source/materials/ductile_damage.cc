// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/ductile_damage.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  std::unique_ptr<const DuctileDamage> DuctileDamage::create(const Entries &e)
  {
    auto damage = e.plugin<DuctileDamage>(
        "Damage", "none",
        "Points have a damage $\\sum \\Delta\\varepsilon_p/\\varepsilon_f$ with the strain at "
        "failure $\\varepsilon_f$ of this law, for `Bond failure = damage`, `Erosion damage` and "
        "`Conversion damage`; it does not change the stress.",
        "none");
    e.plugins<DuctileDamage>();
    return damage;
  }

  FieldDescription DuctileDamage::field()
  {
    return {"damage", "1", FieldLocation::material_point, 1, true};
  }

  void DuctileDamage::advance(const MaterialBatch &batch, const unsigned int begin,
                              const unsigned int n, const double *const old_plastic_strain,
                              const double *const plastic_strain, const double *const temperature,
                              double *const damage) const
  {
    constexpr unsigned int chunk_size = 64;
    alignas(64) double increment[chunk_size], rate[chunk_size], triaxiality[chunk_size],
        failure_strain[chunk_size];
    const double inverse_time_increment =
        batch.time_increment > 0. ? 1. / batch.time_increment : 0.;
    for (unsigned int first = 0; first < n; first += chunk_size)
    {
      const unsigned int size = std::min(chunk_size, n - first);
      double largest = 0.;
      for (unsigned int i = 0; i < size; ++i)
      {
        increment[i] = plastic_strain[first + i] - old_plastic_strain[first + i];
        largest = std::max(largest, increment[i]);
      }
      if (!(largest > 0.))
        continue;
      const double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = batch.stress[c] + begin + first;
#pragma GCC ivdep
      for (unsigned int i = 0; i < size; ++i)
      {
        const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) * (1. / 3.);
        const double xx = stress[0][i] - mean, yy = stress[1][i] - mean, zz = stress[2][i] - mean;
        const double shears =
            stress[3][i] * stress[3][i] + stress[4][i] * stress[4][i] + stress[5][i] * stress[5][i];
        const double effective = std::sqrt(1.5 * (xx * xx + yy * yy + zz * zz) + 3. * shears);
        // A point without shear strength flows at no stress.
        constexpr double tiny = 1e-200;
        triaxiality[i] = mean / (effective > tiny ? effective : tiny);
        rate[i] = inverse_time_increment * increment[i];
      }
      FailureStrainBatch points{size, triaxiality, rate,
                                temperature == nullptr ? nullptr : temperature + first,
                                failure_strain};
      evaluate(points);
      double *const point_damage = damage + first;
#pragma GCC ivdep
      for (unsigned int i = 0; i < size; ++i)
        point_damage[i] += increment[i] / failure_strain[i];
    }
  }
} // namespace tombolo
