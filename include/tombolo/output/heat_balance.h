// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  /** Where the heat of a scene is and where it came from, at one time; sums over all ranks
   * [M L^2/T^2]. */
  struct HeatBalance
  {
    double enthalpy = 0;              ///< Σ H of the nodes; zero at the initial temperatures
    double initial_enthalpy = 0;      ///< at the start
    double pending = 0;               ///< of plastic work and contact, not yet given to nodes
    std::vector<double> of_condition; ///< entered through each condition
    double entered = 0;               ///< their sum
    double plastic = 0;               ///< share of the plastic work that heats
    double friction = 0;              ///< share of the heat of sliding that enters the bodies
    double eroded = 0;                ///< has left with cells that were removed
    double conducted = 0;             ///< into the bodies from tools
    /** (enthalpy + pending + eroded - initial - entered - plastic - friction - conducted) / the
     * largest of these so far, where Σ |H| stands for the enthalpy. */
    double error = 0;
  };
} // namespace tombolo
