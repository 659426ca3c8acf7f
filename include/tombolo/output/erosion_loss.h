// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

namespace tombolo
{
  /** What has left the bodies with the cells that were removed. */
  struct ErosionLoss
  {
    double n_cells = 0;
    double mass = 0; ///< [M]
    /** Kinetic, elastic and of hourglass stiffness; what was dissipated before stays where it is
     * booked [M L^2/T^2]. */
    double energy = 0;
    std::array<double, 3> momentum{};         ///< [M L/T]
    std::array<double, 3> angular_momentum{}; ///< [M L^2/T]
  };
} // namespace tombolo
