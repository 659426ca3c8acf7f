// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/materials/material.h>

#include <cmath>
#include <vector>

namespace tombolo
{
  /**
   * A viscoelastic material: linear elasticity whose deviatoric stress s relaxes, a spring and a
   * dashpot in series,
   *
   * @verbatim
   *   ds/dt + s/τ = 2 G dev(D),   p = K tr(D) in rate form
   * @endverbatim
   *
   * in the rotating frame. The update is exact for a strain rate that is constant in the step.
   * doc/add_a_material.md walks through it.
   */
  class Maxwell : public Material
  {
  public:
    explicit Maxwell(const Entries &e)
    {
      initial_density = e.number("Density", mandatory, positive(), "M/L^3", "At the start.");
      bulk = e.number("Bulk modulus", mandatory, positive(), "M/(L T^2)", "K.");
      shear = e.number("Shear modulus", mandatory, positive(), "M/(L T^2)", "G.");
      relaxation_time = e.number("Relaxation time", mandatory, positive(), "T",
                                 "In which shear stress decays to 1/e.");
    }

    double density() const override
    {
      return initial_density;
    }

    double bulk_modulus() const override
    {
      return bulk;
    }

    double shear_modulus() const override
    {
      return shear;
    }

    std::vector<FieldDescription> internal_variables() const override
    {
      return {energy_field("plastic work")};
    }

    double plastic_heat_fraction() const override
    {
      return 1.;
    }

    void update_stress(MaterialBatch &batch) const override
    {
      const double x = batch.time_increment / relaxation_time;
      const double decay = std::exp(-x);
      const double twice_shear = 2. * shear;
      // The mean of exp(-t/τ) over the step; a first evaluation has no time increment.
      const double gain = twice_shear * (x > 0. ? -std::expm1(-x) / x : 1.);
      double *const work = batch.internal_variables[0];
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        double old_mean = 0, volumetric = 0;
        for (unsigned int c = 0; c < 3; ++c)
        {
          old_mean += batch.stress[c][i] / 3.;
          volumetric += batch.strain_increment[c][i];
        }
        const double mean = old_mean + bulk * volumetric;
        double dissipated = 0; // ½ (s₀ + s₁) : (strain increment of the dashpot)
        for (unsigned int c = 0; c < 6; ++c)
        {
          const bool is_normal = c < 3;
          const double s_0 = batch.stress[c][i] - (is_normal ? old_mean : 0.);
          const double strain = batch.strain_increment[c][i] - (is_normal ? volumetric / 3. : 0.);
          const double s_1 = decay * s_0 + gain * strain;
          const double dashpot_strain = strain - (s_1 - s_0) / twice_shear;
          dissipated += (is_normal ? 0.5 : 1.) * (s_0 + s_1) * dashpot_strain;
          batch.stress[c][i] = s_1 + (is_normal ? mean : 0.);
        }
        work[i] += dissipated; // per initial volume
      }
    }

  private:
    double initial_density; // [M/L^3]
    double bulk, shear;     // [M/(L T^2)]
    double relaxation_time; // [T]
  };

  TOMBOLO_REGISTER(Material, Maxwell, "maxwell", "elasticity whose shear stress relaxes")
} // namespace tombolo
