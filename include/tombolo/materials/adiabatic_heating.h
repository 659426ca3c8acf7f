// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/thermal_properties.h>

namespace tombolo
{
  /** How the plastic work of a material heats its points, as its section says it. */
  struct AdiabaticHeating
  {
    /** @p heat is the section "Heat" of the material, null without one; @p needs_temperature tells
     * whether something depends on the temperature. Throws InputError. */
    AdiabaticHeating(const Entries &e, const ThermalProperties *heat, double density,
                     const FlowStress *flow_stress, bool needs_temperature);

    double taylor_quinney = 0; ///< η
    double per_work = 0;       ///< η/(ρ₀ c): temperature per plastic work per initial volume
    double initial_temperature = 0; ///< where points keep it
    bool is_kept = false;           ///< points keep a temperature of their own
  };
} // namespace tombolo
