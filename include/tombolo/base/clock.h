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
    /** t_0 less the time of the velocities at the start: zero where they are given at t_0, half of
     * the last step of the run that this one continues. */
    double start_lag = 0;

    /** t_n less the time of the velocities. */
    double velocity_lag() const
    {
      return step == 0 ? start_lag : 0.5 * previous_step;
    }

    /** The time of the velocities, t_{n-1/2}. */
    double velocity_time() const
    {
      return time - velocity_lag();
    }

    /** Δt_n = t_{n+1/2} - t_{n-1/2}; half a step where velocities are given at t_0. */
    double velocity_step() const
    {
      return 0.5 * (previous_step + next_step) + (step == 0 ? start_lag : 0.);
    }

    /** Whether velocities are those of t_n, and not those of t_{n-1/2}. */
    bool has_present_velocities() const
    {
      return step == 0 && start_lag == 0.;
    }

    void advance()
    {
      ++step;
      time += next_step;
      previous_step = next_step;
    }
  };

  /**
   * The impulse of a force in the step from t_{n-1} to t_n, ½ (Δt_{n-1} f_{n-1} + Δt_n f_n): times
   * v_{n-1/2} it is the work that the kinetic energy ½ v_{n-1/2} · m v_{n+1/2} receives. @p impulse
   * is Δt_n f_n, and @p previous, which is Δt_{n-1} f_{n-1}, becomes that of the next step. No step
   * leads to the start.
   */
  template <typename Impulse>
  Impulse impulse_of_step(const Impulse &impulse, Impulse &previous, const Clock &clock)
  {
    const Impulse result = clock.step == 0 ? Impulse() : 0.5 * (impulse + previous);
    // Where velocities are given at t_0, Δt_0 is half a step; as the beginning of the first
    // interval a force counts whole, like at any other.
    previous = clock.has_present_velocities() ? 2. * impulse : impulse;
    return result;
  }
} // namespace tombolo
