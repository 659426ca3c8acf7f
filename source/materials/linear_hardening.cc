// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>

namespace tombolo
{
  /** σ_y = Y + H ε_p, times the factor of CowperSymonds. */
  class LinearHardening : public FlowStress
  {
  public:
    explicit LinearHardening(const Entries &e)
    {
      yield_stress = e.number("Yield stress", mandatory, positive(), "M/(L T^2)",
                              "Flow stress $Y$ without plastic strain.");
      hardening_modulus =
          e.number("Hardening modulus", "0", zero_or_positive(), "M/(L T^2)",
                   "Slope $H$ of the flow stress over the effective plastic strain, "
                   "zero for perfect plasticity.");
      rate_factor = CowperSymonds(e);
    }

    bool depends_on_temperature() const override
    {
      return false;
    }

    void evaluate(const FlowStressBatch &batch) const override
    {
#pragma GCC ivdep
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        batch.flow_stress[i] = yield_stress + hardening_modulus * batch.plastic_strain[i];
        batch.slope[i] = hardening_modulus;
      }
      rate_factor.apply(batch);
    }

  private:
    double yield_stress;      // Y [M/(L T^2)]
    double hardening_modulus; // H [M/(L T^2)]
    CowperSymonds rate_factor;
  };

  TOMBOLO_REGISTER(FlowStress, LinearHardening, "linear hardening",
                   "a yield stress and a constant hardening modulus")
} // namespace tombolo
