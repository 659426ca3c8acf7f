// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** Times of the central difference scheme at step n, variable steps: eqs (22)-(24). */
  struct Clock
  {
    unsigned long step = 0;   ///< n
    double time = 0;          ///< t_n
    double previous_step = 0; ///< t_n - t_{n-1}; zero at the start
    double next_step = 0;     ///< t_{n+1} - t_n
    double stable_step = 0;   ///< the limit of the step at this configuration

    /** Δt_n = t_{n+1/2} - t_{n-1/2}; at the start, where velocities are given at t_0, half a step.
     */
    double velocity_step() const
    {
      return 0.5 * (previous_step + next_step);
    }

    void advance()
    {
      ++step;
      time += next_step;
      previous_step = next_step;
    }
  };
} // namespace tombolo
