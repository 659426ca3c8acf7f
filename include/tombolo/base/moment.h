// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

namespace tombolo
{
  /** Adds the moment about the origin of a force, or of an impulse, at @p position to @p moment;
   * position and force have three components. */
  inline void add_moment(const double *position, const double *force, std::array<double, 3> &moment)
  {
    moment[0] += position[1] * force[2] - position[2] * force[1];
    moment[1] += position[2] * force[0] - position[0] * force[2];
    moment[2] += position[0] * force[1] - position[1] * force[0];
  }
} // namespace tombolo
