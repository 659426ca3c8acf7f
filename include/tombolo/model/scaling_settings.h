// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

namespace tombolo
{
  /**
   * Section "Scaling": what makes a quasi-static process cheaper to follow with explicit steps.
   *
   * A process that runs s times faster, with everything that has a time in it carried along
   * (conductivity, film coefficients and radiation times s, reference strain rates times s,
   * functions of s t), is in its own time the same as one with s² times the inertia and all else as
   * it is. So nothing is carried along: the file stays in the time of the process, and inertia is
   * multiplied by inertia_factor().
   */
  struct ScalingSettings
  {
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Nothing scaled. */
    ScalingSettings() = default;

    /** Reads the section. Throws InputError. */
    explicit ScalingSettings(const Section &section);

    /** Of the density of all materials. */
    double inertia_factor() const;

    /** Whether anything is scaled. */
    bool is_active() const;

    /** Whether the mass of single cells and particles is. */
    bool is_selective() const;

    double mass_factor = 1.;
    double process_time_factor = 1.;
    double target_time_step = 0.; ///< by eq. (41) [T]; zero: none
    unsigned int interval = 0;    ///< steps between looks at the target

    /** The largest factor allowed; its inverse is the smallest. */
    static constexpr double largest_factor = 1e12;
  };
} // namespace tombolo
