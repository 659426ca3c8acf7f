// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <array>
#include <string>

namespace tombolo
{
  /** Forces, impulses and energies of a contact at one time. */
  struct ContactBalance
  {
    std::string name;                        ///< of the contact, for tables
    std::array<double, 3> force{};           ///< of the surface on the bodies, at t_n [M L/T^2]
    std::array<double, 3> impulse{};         ///< of that force since the start [M L/T]
    std::array<double, 3> angular_impulse{}; ///< of its torque about the surface's reference point,
                                             ///< wherever that was [M L^2/T]
    double elastic = 0;                      ///< stored in the penalty springs [M L^2/T^2]
    double friction = 0;                     ///< turned into heat by sliding
    double damping = 0;                      ///< taken by damping and by changes of the stiffness
    double work = 0;                         ///< done by the motion of the surface on the bodies
    /** Put in from outside: `work` of a surface that moves by functions of time; that of the given
     * force and of the turning of one that has a mass. */
    double external_work = 0;
    double conducted = 0;          ///< heat that the bodies have got by conduction
    double friction_of_bodies = 0; ///< their share of `friction`; zero without heat
    double heat_of_bodies = 0;     ///< that, and their share of `friction`; zero without heat
    double heat_of_tool = 0;       ///< what the tool has got, or with a heat capacity what it holds
    double tool_temperature = 0;
    std::array<double, 3> position{};      ///< of the surface's reference point, at t_n [L]
    std::array<double, 3> velocity{};      ///< of a surface with a mass, at t_{n-1/2} [L/T]
    std::array<double, 3> tool_momentum{}; ///< likewise [M L/T]
    double tool_kinetic = 0;               ///< ½ m v_{n-1/2} · v_{n+1/2}
    double n_nodes = 0;                    ///< in contact
    double area = 0;                       ///< likewise, where areas are known [L^(dim-1)]
    double penetration = 0;                ///< the largest [L]

    /** Adds those of another contact, but for what is of one surface alone: torque, place, area. */
    void add(const ContactBalance &other)
    {
      for (unsigned int d = 0; d < 3; ++d)
      {
        force[d] += other.force[d];
        impulse[d] += other.impulse[d];
        tool_momentum[d] += other.tool_momentum[d];
      }
      elastic += other.elastic;
      friction += other.friction;
      damping += other.damping;
      work += other.work;
      external_work += other.external_work;
      conducted += other.conducted;
      friction_of_bodies += other.friction_of_bodies;
      heat_of_bodies += other.heat_of_bodies;
      heat_of_tool += other.heat_of_tool;
      tool_kinetic += other.tool_kinetic;
      n_nodes += other.n_nodes;
      penetration = std::max(penetration, other.penetration);
    }
  };
} // namespace tombolo
