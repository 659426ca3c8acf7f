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
