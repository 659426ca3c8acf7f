// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/material.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tombolo
{
  bool Material::remembers(const std::string &variable) const
  {
    const std::vector<FieldDescription> variables = internal_variables();
    return std::any_of(variables.begin(), variables.end(),
                       [&](const FieldDescription &field) { return field.name == variable; });
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
                                        const double *temperature, double *energy_density) const
  {
    constexpr unsigned int chunk_size = 64;
    double bulk[chunk_size], shear[chunk_size];
    for (unsigned int begin = 0; begin < n; begin += chunk_size)
    {
      const unsigned int end = std::min(begin + chunk_size, n);
      elastic_moduli(end - begin, temperature == nullptr ? nullptr : temperature + begin, bulk,
                     shear);
      for (unsigned int i = begin; i < end; ++i)
      {
        const double bulk_compliance = 1. / (2. * bulk[i - begin]);
        const double shear_compliance = 1. / (4. * shear[i - begin]);
        const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) / 3.;
        const double xx = stress[0][i] - mean, yy = stress[1][i] - mean, zz = stress[2][i] - mean;
        const double shears =
            stress[3][i] * stress[3][i] + stress[4][i] * stress[4][i] + stress[5][i] * stress[5][i];
        energy_density[i] = bulk_compliance * mean * mean +
                            shear_compliance * (xx * xx + yy * yy + zz * zz + 2. * shears);
      }
    }
  }

  void Material::update_stress_and_tangent(MaterialBatch &batch,
                                           const MaterialTangent &tangent) const
  {
    constexpr double change = 1e-7;
    const unsigned int n = batch.n;
    std::vector<double *> updated = batch.internal_variables;
    updated.insert(updated.end(), batch.stress, batch.stress + 6);
    dealii::AlignedVector<double> kept(updated.size() * n), strain(6 * n);
    for (std::size_t v = 0; v < updated.size(); ++v)
      std::copy_n(updated[v], n, kept.data() + v * n);
    MaterialBatch changed = batch;
    for (unsigned int c = 0; c < 6; ++c)
    {
      changed.strain_increment[c] = strain.data() + c * n;
      std::copy_n(batch.strain_increment[c], n, strain.data() + c * n);
    }
    for (unsigned int column = 0; column < 6; ++column)
    {
      double *const changed_strain = strain.data() + column * n;
      for (unsigned int i = 0; i < n; ++i)
        changed_strain[i] += change;
      update_stress(changed);
      for (unsigned int row = 0; row < 6; ++row)
        std::copy_n(batch.stress[row], n, tangent[6 * row + column]);
      std::copy_n(batch.strain_increment[column], n, changed_strain);
      for (std::size_t v = 0; v < updated.size(); ++v)
        std::copy_n(kept.data() + v * n, n, updated[v]);
    }
    update_stress(batch);
    for (unsigned int row = 0; row < 6; ++row)
      for (unsigned int column = 0; column < 6; ++column)
        for (unsigned int i = 0; i < n; ++i)
        {
          double &entry = tangent[6 * row + column][i];
          entry = (entry - batch.stress[row][i]) / change;
        }
  }
} // namespace tombolo
