// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string>

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

  /** The resultant of a load over the nodes of one rank. */
  struct LoadSum
  {
    std::array<double, 3> force{};  ///< [M L/T^2]
    std::array<double, 3> moment{}; ///< about the origin of coordinates [M L^2/T^2]

    /** Adds a force at @p position; both have three components. */
    void add(const double *position, const double *nodal_force)
    {
      for (unsigned int c = 0; c < 3; ++c)
        force[c] += nodal_force[c];
      add_moment(position, nodal_force, moment);
    }
  };

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
