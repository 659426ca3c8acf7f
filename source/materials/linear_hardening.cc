// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/linear_hardening.h>

#include <tombolo/base/input/parameters.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  LinearHardening::LinearHardening(const Entries &e)
  {
    yield_stress = e.number("Yield stress", mandatory, positive(), "M/(L T^2)",
                            "Flow stress $Y$ without plastic strain.");
    hardening_modulus = e.number("Hardening modulus", "0", zero_or_positive(), "M/(L T^2)",
                                 "Slope $H$ of the flow stress over the effective plastic strain, "
                                 "zero for perfect plasticity.");
  }

  bool LinearHardening::depends_on_temperature() const
  {
    return false;
  }

  void LinearHardening::evaluate(const FlowStressBatch &batch) const
  {
#pragma GCC ivdep
    for (unsigned int i = 0; i < batch.n; ++i)
    {
      batch.flow_stress[i] = yield_stress + hardening_modulus * batch.plastic_strain[i];
      batch.slope[i] = hardening_modulus;
    }
  }

  TOMBOLO_REGISTER(FlowStress, LinearHardening, "linear hardening",
                   "a yield stress and a constant hardening modulus")
} // namespace tombolo
