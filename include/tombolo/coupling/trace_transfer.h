// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/mass_split.h>

namespace tombolo
{
  /** The trace bridge: elements see the field of the particles at shared nodes, and their forces
   * there return by the transpose. */
  class TraceTransfer
  {
  public:
    /** @p split must outlive this. */
    explicit TraceTransfer(const MassSplit &split) : split(split) {}

    /** @p velocity with the field Σ φ_J v_J at shared nodes, but for prescribed components. With
     * current ghosts, as those of @p velocity must be; valid until the next call. Collective. */
    const NodalVector &field_of_particles(const NodalVector &velocity);

    /** Adds the forces of elements (ghosts are collected here) to those of the particles.
     * Collective. */
    void add_element_force(NodalVector &element_force, NodalVector &force);

  private:
    const MassSplit &split;
    NodalVector trace_velocity, trace_force;
  };
} // namespace tombolo
