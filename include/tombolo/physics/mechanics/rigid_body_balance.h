// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/impulse_balance.h>

#include <array>

namespace tombolo
{
  /** Where a rigid body is, how it moves, and what its drive does to it; the same on all ranks.
   * Impulses are those of what holds and drives the prescribed components, until t_{n+1/2} and with
   * moments about the reference point; the work is that of the drive and of given forces. In two
   * dimensions rotations, spins and moments are about z. */
  struct RigidBodyBalance : ImpulseBalance
  {
    using Vector = std::array<double, 3>;

    Vector position{};          ///< of the reference point at t_n [L]
    Vector rotation{};          ///< the rotation vector from the start to t_n [rad]
    Vector velocity{};          ///< of the reference point at t_{n-1/2} [L/T]
    Vector spin{};              ///< the angular velocity at t_{n-1/2} [rad/T]
    Vector momentum{};          ///< at t_{n-1/2} [M L/T]
    Vector angular_momentum{};  ///< about the centre of mass, likewise [M L^2/T]
    double kinetic_energy = 0;  ///< at t_n, of translation and rotation [M L^2/T^2]
    double rotation_energy = 0; ///< the part of it that is of rotation about the centre of mass
  };
} // namespace tombolo
