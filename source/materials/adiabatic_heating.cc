// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/adiabatic_heating.h>

namespace tombolo
{
  using namespace dealii;

  AdiabaticHeating::AdiabaticHeating(const Entries &e, const ThermalProperties *const heat,
                                     const double density, const FlowStress *const flow_stress,
                                     const bool needs_temperature)
  {
    taylor_quinney =
        e.number("Taylor-Quinney coefficient", "0", from_to(0., 1.), "1",
                 "The share $\\eta$ of the plastic work that heats the material, from 0 to 1.");
    if (heat != nullptr)
    {
      for (const char *const entry : {"Specific heat capacity", "Initial temperature"})
        e.refuse(e.is_set(entry), entry,
                 "the section \"Heat\" of the material says it already; allowed is one of both.");
      const double start = heat->initial_temperature();
      per_work = taylor_quinney / (density * heat->capacity().value(start));
      flow_stress->check_initial_temperature(start);
      return;
    }
    if (e.when(taylor_quinney > 0.))
    {
      const double capacity = e.number(
          "Specific heat capacity", mandatory, positive(), "L^2/(T^2 temperature)",
          "$c$ per mass, where plastic work heats and the material has no section \"Heat\".");
      if (!e.declares())
        per_work = taylor_quinney / (density * capacity);
    }
    is_kept = per_work > 0. || needs_temperature;
    if (!e.when(is_kept))
      return;
    initial_temperature =
        e.number("Initial temperature", mandatory, any_number(), "",
                 "The temperature at the start, where plastic work heats or the flow stress or the "
                 "damage depends on the temperature, and the material has no section \"Heat\".");
    if (flow_stress != nullptr)
      flow_stress->check_initial_temperature(initial_temperature);
  }
} // namespace tombolo
