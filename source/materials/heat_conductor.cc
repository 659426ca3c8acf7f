// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/materials/material.h>

#include <algorithm>

namespace tombolo
{
  /** Has mass and no stress: for scenes of heat alone, which need no elastic constants. */
  class HeatConductor : public Material
  {
  public:
    explicit HeatConductor(const Entries &e)
        : initial_density(e.number("Density", mandatory, positive(), "M/L^3",
                                   "Density in the initial configuration."))
    {}

    double density() const override
    {
      return initial_density;
    }

    bool has_mechanics() const override
    {
      return false;
    }

    double bulk_modulus() const override
    {
      return 0.;
    }

    double shear_modulus() const override
    {
      return 0.;
    }

    void update_stress(MaterialBatch & /*batch*/) const override {}
    void elastic_energy_density(const unsigned int n, const double *const /*stress*/[6],
                                const double * /*temperature*/,
                                double *energy_density) const override
    {
      std::fill_n(energy_density, n, 0.);
    }

  private:
    double initial_density; // [M/L^3]
  };

  TOMBOLO_REGISTER(Material, HeatConductor, "heat conductor",
                   "no stress, for scenes of heat alone and rigid parts")
} // namespace tombolo
