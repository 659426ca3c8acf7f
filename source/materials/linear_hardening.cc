// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/linear_hardening.h>

#include <tombolo/base/input/parameters.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  void LinearHardening::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(handler, "Yield stress", Patterns::Double(),
                                  "Flow stress $Y$ without plastic strain. Units: M/(L T^2).");
    handler.declare_entry(
        "Hardening modulus", "0", Patterns::Double(),
        "Slope $H$ of the flow stress over the effective plastic strain, zero for "
        "perfect plasticity. Units: M/(L T^2).");
  }

  LinearHardening::LinearHardening(const Section &section)
      : yield_stress(section.get_positive("Yield stress")),
        hardening_modulus(section.get_double("Hardening modulus"))
  {
    if (!(hardening_modulus >= 0. && std::isfinite(hardening_modulus)))
      section.fail("Hardening modulus", "allowed is zero or a positive number.");
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
