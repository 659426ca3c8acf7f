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
} // namespace tombolo
