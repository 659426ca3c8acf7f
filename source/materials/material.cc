// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/material.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  std::vector<FieldDescription> Material::internal_variables() const
  {
    return {};
  }

  double Material::longitudinal_wave_speed() const
  {
    return std::sqrt((bulk_modulus() + 4. / 3. * shear_modulus()) / inertial_density());
  }

  double Material::shear_wave_speed() const
  {
    return std::sqrt(shear_modulus() / inertial_density());
  }

  void Material::elastic_moduli(const unsigned int n, const double * /*temperature*/,
                                double *const bulk, double *const shear) const
  {
    std::fill_n(bulk, n, bulk_modulus());
    std::fill_n(shear, n, shear_modulus());
  }

  void Material::elastic_energy_density(const unsigned int n, const double *const stress[6],
                                        const double * /*temperature*/,
                                        double *energy_density) const
  {
    const double bulk_compliance = 1. / (2. * bulk_modulus());
    const double shear_compliance = 1. / (4. * shear_modulus());
    for (unsigned int i = 0; i < n; ++i)
    {
      const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) / 3.;
      const double xx = stress[0][i] - mean;
      const double yy = stress[1][i] - mean;
      const double zz = stress[2][i] - mean;
      const double shear =
          stress[3][i] * stress[3][i] + stress[4][i] * stress[4][i] + stress[5][i] * stress[5][i];
      energy_density[i] = bulk_compliance * mean * mean +
                          shear_compliance * (xx * xx + yy * yy + zz * zz + 2. * shear);
    }
  }
} // namespace tombolo
