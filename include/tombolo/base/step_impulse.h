// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>

namespace tombolo
{
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
