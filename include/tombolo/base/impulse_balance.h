// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string>

namespace tombolo
{
  /** What acts on the bodies or passes through them, such as a contact, a condition or a section:
   * sums over all ranks since the start. Tables have the means of these from row to row. */
  struct ImpulseBalance
  {
    std::string name;                        ///< for tables
    std::array<double, 3> impulse{};         ///< until `time_of_impulse` [M L/T]
    std::array<double, 3> angular_impulse{}; ///< of the moments, likewise [M L^2/T]
    double time_of_impulse = 0;              ///< [T]
    double work = 0;                         ///< until t_n [M L^2/T^2]
  };
} // namespace tombolo
