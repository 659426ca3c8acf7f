// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>

namespace tombolo
{
  /** Where the heat of a scene is and where it came from, at one time; sums over all ranks
   * [M L^2/T^2]. */
  struct HeatBalance
  {
    /** "enthalpy" of the nodes (zero at the initial temperatures), "heat through NAME" of each
     * condition, "plastic heat", "pending heat" (not yet given to nodes), and what processes have
     * given. */
    EnergyAccounts heat;
    double initial_enthalpy = 0; ///< at the start
    double external = 0;         ///< entered since
    double magnitude = 0;        ///< Σ |H|
    /** (held - initial - external) / the largest of these so far, where Σ |H| stands for the
     * enthalpy. */
    double error = 0;
  };
} // namespace tombolo
