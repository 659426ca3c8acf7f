// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>

#include <array>

namespace tombolo
{
  /** The resultant of a load over the nodes of one rank. */
  struct LoadSum
  {
    std::array<double, 3> force{};  ///< [M L/T^2]
    std::array<double, 3> moment{}; ///< about the origin of coordinates [M L^2/T^2]

    /** Adds a force at @p position; both have three components. */
    void add(const double *position, const double *of_node)
    {
      for (unsigned int c = 0; c < 3; ++c)
        force[c] += of_node[c];
      add_moment(position, of_node, moment);
    }
  };
} // namespace tombolo
