// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/material.h>

namespace tombolo
{
  /** Has mass and no stress: for scenes of heat alone, which need no elastic constants. */
  class HeatConductor : public Material
  {
  public:
    explicit HeatConductor(const Entries &e);
    double density() const override;
    bool has_mechanics() const override;
    double bulk_modulus() const override;
    double shear_modulus() const override;
    void update_stress(MaterialBatch &batch) const override;
    void elastic_energy_density(unsigned int n, const double *const stress[6],
                                const double *temperature, double *energy_density) const override;

  private:
    double initial_density; // [M/L^3]
  };
} // namespace tombolo
