// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/adiabatic_heating.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  void AdiabaticHeating::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Taylor-Quinney coefficient", "0", Patterns::Double(),
        "The share $\\eta$ of the plastic work that heats the material, from 0 to "
        "1. Units: 1.");
    Parameters::declare_mandatory(handler, "Specific heat capacity", Patterns::Double(),
                                  "$c$ per mass, where plastic work heats and the material has no "
                                  "section \"Heat\". Units: L^2/(T^2 temperature).");
    Parameters::declare_mandatory(handler, "Initial temperature", Patterns::Double(),
                                  "The temperature at the start, where plastic work heats or the "
                                  "flow stress or the damage depends on the temperature, and the "
                                  "material has no section \"Heat\".");
  }

  AdiabaticHeating AdiabaticHeating::read(const Section &section,
                                          const ThermalProperties *const heat, const double density,
                                          const FlowStress &flow_stress,
                                          const bool needs_temperature)
  {
    AdiabaticHeating result;
    result.taylor_quinney = section.get_double("Taylor-Quinney coefficient");
    if (!(result.taylor_quinney >= 0. && result.taylor_quinney <= 1.))
      section.fail("Taylor-Quinney coefficient", "allowed is a number from 0 to 1.");
    if (heat != nullptr)
    {
      for (const char *const entry : {"Specific heat capacity", "Initial temperature"})
        if (section.is_set(entry))
          section.fail(entry,
                       "the section \"Heat\" of the material says it already; allowed is one "
                       "of both.");
      const double start = heat->initial_temperature();
      result.per_work = result.taylor_quinney / (density * heat->capacity().value(start));
      flow_stress.check_initial_temperature(start);
      return result;
    }
    if (result.taylor_quinney > 0.)
      result.per_work =
          result.taylor_quinney / (density * section.get_positive("Specific heat capacity"));
    result.is_kept = result.per_work > 0. || needs_temperature;
    if (result.is_kept)
    {
      result.initial_temperature = section.get_double("Initial temperature");
      if (!std::isfinite(result.initial_temperature))
        section.fail("Initial temperature", "allowed is a finite number.");
      flow_stress.check_initial_temperature(result.initial_temperature);
    }
    return result;
  }
} // namespace tombolo
