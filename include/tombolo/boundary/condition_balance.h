// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string>

namespace tombolo
{
  /** What a mechanical condition, a support, a drive or a load, does to the bodies; sums over all
   * its nodes and ranks. Moments are about the origin of coordinates. */
  struct ConditionBalance
  {
    std::string name;                        ///< of the condition
    bool prescribes_motion = false;          ///< otherwise it is a load
    std::array<double, 3> impulse{};         ///< from the start to `time_of_impulse` [M L/T]
    std::array<double, 3> angular_impulse{}; ///< likewise [M L^2/T]
    double time_of_impulse = 0;              ///< t_{n-1/2}, that of the momentum [T]
    double work = 0;                         ///< since the start, until t_n [M L^2/T^2]
    double n_nodes = 0;                      ///< not of loads
    /** x - X at t_n, the mean over the nodes with the same weight each; not of loads [L]. */
    std::array<double, 3> displacement{};
  };
} // namespace tombolo
