// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string>

namespace tombolo
{
  /** What passes through a section of the bodies; sums over all ranks. */
  struct SectionBalance
  {
    std::string name;
    std::array<double, 3> impulse{};         ///< from the start to `time_of_impulse` [M L/T]
    std::array<double, 3> angular_impulse{}; ///< likewise, about the section's point [M L^2/T]
    double time_of_impulse = 0;              ///< t_{n-1/2}, that of the momentum [T]
  };
} // namespace tombolo
