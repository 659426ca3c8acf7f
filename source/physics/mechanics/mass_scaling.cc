// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mass_scaling.h>

#include <tombolo/model/process.h>

namespace tombolo
{
  ScalingSettings::ScalingSettings(const Entries &e)
  {
    mass_factor = e.number("Mass factor", "1", positive(), "1",
                           "Mass scaling: inertia is that of so many times the density, and steps "
                           "are larger by its root. Heat capacity and body forces stay.");
    process_time_factor = e.number(
        "Process time factor", "1", positive(), "1",
        "The process is run so many times faster, and conductivities, film and radiation "
        "coefficients and reference strain rates are carried along. All entries, functions and "
        "results stay in the time of the process: steps are so many times larger.");
    const double factor = inertia_factor();
    e.refuse(!(factor <= largest_factor && factor >= 1. / largest_factor),
             process_time_factor == 1. ? "Mass factor" : "Process time factor",
             "inertia would be multiplied by " + format_number(mass_factor) + " x " +
                 format_number(process_time_factor) +
                 "^2; allowed are factors from 1e-12 to 1e12.");
    if (!e.when(e.is_set("Target time step")))
      return;
    target_time_step =
        e.optional_number("Target time step", positive(), "T",
                          "Selective mass scaling: mass is added to each cell and particle whose "
                          "own stable step by eq. (41) of Pan et al. 2019 is smaller, so that it "
                          "becomes this one; empty for none.")
            .value_or(0.);
    interval = e.integer("Interval", "20", between(1, 1000000),
                         "With a target: after so many steps mass is added again where cells have "
                         "become smaller. It is never taken away.");
  }

  TOMBOLO_REGISTER_PROCESS(MassScaling, process_order::mass_scaling)
} // namespace tombolo
