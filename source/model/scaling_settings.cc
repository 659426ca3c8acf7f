// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/scaling_settings.h>

#include <tombolo/base/format.h>

namespace tombolo
{
  using namespace dealii;

  void ScalingSettings::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Mass factor", "1", Patterns::Double(),
        "Mass scaling: inertia is that of so many times the density, and steps are larger by its "
        "root. Heat capacity and body forces stay. Units: 1.");
    handler.declare_entry(
        "Process time factor", "1", Patterns::Double(),
        "The process is run so many times faster, and conductivities, film and radiation "
        "coefficients and reference strain rates are carried along. All entries, functions and "
        "results stay in the time of the process: steps are so many times larger. Units: 1.");
    handler.declare_entry(
        "Target time step", "", Patterns::Anything(),
        "Selective mass scaling: mass is added to each cell and particle whose own stable step by "
        "eq. (41) of Pan et al. 2019 is smaller, so that it becomes this one; empty for none. "
        "Units: T.");
    handler.declare_entry(
        "Interval", "20", Patterns::Integer(1, 1000000),
        "With a target: after so many steps mass is added again where cells have become smaller. "
        "It is never taken away.");
  }

  ScalingSettings::ScalingSettings(const Section &section)
      : mass_factor(section.get_positive("Mass factor")),
        process_time_factor(section.get_positive("Process time factor"))
  {
    const double factor = inertia_factor();
    if (!(factor <= largest_factor && factor >= 1. / largest_factor))
      section.fail(process_time_factor == 1. ? "Mass factor" : "Process time factor",
                   "inertia would be multiplied by " + format_number(mass_factor) + " x " +
                       format_number(process_time_factor) +
                       "^2; allowed are factors from 1e-12 to 1e12.");
    if (!section.is_set("Target time step"))
      return;
    target_time_step = section.get_positive("Target time step");
    interval = section.get_unsigned("Interval");
  }

  double ScalingSettings::inertia_factor() const
  {
    return mass_factor * process_time_factor * process_time_factor;
  }

  bool ScalingSettings::is_active() const
  {
    return inertia_factor() != 1. || is_selective();
  }

  bool ScalingSettings::is_selective() const
  {
    return target_time_step > 0.;
  }
} // namespace tombolo
