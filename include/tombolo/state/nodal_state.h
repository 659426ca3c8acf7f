// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/field.h>
#include <tombolo/state/nodal_vector.h>

#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The state at the nodes. Velocities are at t_{n-1/2}, positions and forces at t_n
   * (doc/method.md, section 5). At a particle or shared node, velocity is the smoothed nodal
   * parameter v = S v̂; at an FE node v = v̂.
   */
  class NodalState
  {
  public:
    NodalVector initial_position;    ///< X [L]
    NodalVector position;            ///< x at t_n [L]
    NodalVector unsmoothed_velocity; ///< v̂ at t_{n-1/2} [L/T], eq. (22)
    /** x̂ at t_n, X + ∫ v̂ dt: where affine smoothing takes angular momentum, whose positions are
     * x = S x̂. Empty with other smoothing. [L] */
    NodalVector unsmoothed_position;
    NodalVector velocity;     ///< v at t_{n-1/2} [L/T], eq. (12)
    NodalVector force;        ///< internal and external force at t_n [M L/T^2], eqs (14), (16)
    NodalVector acceleration; ///< at t_n [L/T^2], eq. (20)
    NodalVector mass;         ///< m̂ that resists acceleration, scaled where it is, one slot [M]

    /** Allocates the fields, zero. Without mechanics there are positions only. */
    void reinit(const std::shared_ptr<const NodePartition> &partition, bool has_mechanics = true,
                bool has_unsmoothed_position = false);

    /** The positions that v̂ moves: x̂, or x where both are the same. */
    const NodalVector &position_of_unsmoothed() const
    {
      return has_unsmoothed_position ? unsmoothed_position : position;
    }

    /** Moves all fields to other ghosts. Collective. */
    void move_to(const std::shared_ptr<const NodePartition> &partition);

    const std::shared_ptr<const NodePartition> &partition() const
    {
      return position.partition();
    }

    /** Every field with its description: what output and checkpoint iterate over. */
    std::vector<std::pair<FieldDescription, NodalVector *>> fields();

  private:
    bool moves = true;
    bool has_unsmoothed_position = false;
  };

  /**
   * Heat at the nodes, at the ends of the thermal step in progress: t_n^θ <= t <= t_{n+1}^θ. As for
   * velocities, particles have an unsmoothed temperature θ̂ that belongs to their enthalpy, and a
   * field θ^h = Φ S θ̂ (eqs 28, 40); at a node of elements the two are the same. Temperatures are in
   * slot 0 of node_stride, so that the bridge can smooth them.
   *
   * The conserved quantity is the enthalpy of a node, Σ m̂ h(θ̂) over the parts that meet there. It
   * is zero at the initial temperatures of the materials.
   */
  class ThermalState
  {
  public:
    NodalVector enthalpy;               ///< at t_n^θ, scalar [M L^2/T^2]
    NodalVector unsmoothed_temperature; ///< θ̂ at t_n^θ
    NodalVector temperature;            ///< θ^h at t_n^θ
    NodalVector next_enthalpy;          ///< at t_{n+1}^θ, without heat that arises during the step
    NodalVector next_unsmoothed_temperature;
    NodalVector next_temperature;
    NodalVector present_temperature; ///< θ^h at the present time, between the two
    /** Heat at positions of processes since t_n^θ which nodes receive at the end of
     * the step, scalar, owned values [M L^2/T^2]. */
    NodalVector pending;

    /** Allocates all fields, zero. */
    void reinit(const std::shared_ptr<const NodePartition> &partition);

    /** Moves all fields to other ghosts. Collective. */
    void move_to(const std::shared_ptr<const NodePartition> &partition);

    /** Every field with its description. */
    std::vector<std::pair<FieldDescription, NodalVector *>> fields();
  };
} // namespace tombolo
