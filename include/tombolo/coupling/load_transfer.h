// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/mass_split.h>

#include <vector>

namespace tombolo
{
  /** The trace bridge: elements have the field of the particles at shared nodes, and their forces
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

  /** Nodal forces of loads. Tractions and body forces act at the field of the nodal parameters, Φ
   * x, and enter by Φᵀ: without it a load that begins at once would leave a mode behind in the
   * outermost layers of particles, where no wave removes it. Where rows are lumped they act at the
   * nodes. Forces that depend on the positions of nodes, of contact, act where these are: at Φ v
   * with smoothings whose positions move with it, and at the nodes themselves where positions move
   * with the nodal velocity. */
  class LoadTransfer
  {
  public:
    /** @p split must outlive this; @p direct: positions move with the nodal velocities. */
    LoadTransfer(const MassSplit &split, const bool direct) : split(split), direct(direct) {}

    /** Whether loads of some particles act at the nodes, since their rows are lumped. */
    bool acts_at_nodes() const
    {
      return split.has_lumped_rows;
    }

    /** To be called when the split has changed. */
    void reset_rows()
    {
      position_in_own.clear();
    }

    /** Adds Φᵀ of the loads at these owned nodes to @p force. Ghosts are not collected. */
    void add_force_of_loads(const std::vector<unsigned int> &nodes, const NodalVector &loads,
                            NodalVector &force);

    /** Φ @p field at these nodes: of positions, the points where the loads act, with the moments of
     * the nodal forces. @p field has current ghosts; @p result is the same at other nodes, and has
     * current ghosts. Collective. */
    void field_at_loads(const std::vector<unsigned int> &nodes, const NodalVector &field,
                        NodalVector &result)
    {
      result.copy_from(field);
      interpolate_rows(nodes, field, result);
      result.distribute();
    }

    /** The transpose of add_force_of_loads() at all owned nodes: @p result = Φ @p field, with
     * current ghosts. @p field has them. Collective. */
    void interpolate(const NodalVector &field, NodalVector &result) const;

    /** Adds the forces that act at the positions of these owned nodes to @p force, wherever
     * positions are. Ghosts are not collected. */
    void add_force_at_positions(const std::vector<unsigned int> &nodes, const NodalVector &loads,
                                NodalVector &force);

    /** Φ @p field at these owned nodes, the transpose of add_force_at_positions(); elsewhere @p
     * result stays. Ghosts of @p field must be current. */
    void interpolate(const std::vector<unsigned int> &nodes, const NodalVector &field,
                     NodalVector &result);

  private:
    static constexpr unsigned int is_nowhere = static_cast<unsigned int>(-1);
    void find_positions_in_lists();
    void interpolate_rows(const std::vector<unsigned int> &nodes, const NodalVector &field,
                          NodalVector &result);

    const MassSplit &split;
    bool direct;
    // By owned node; made when needed.
    std::vector<unsigned int> position_in_own;
    std::vector<std::vector<unsigned int>> row_of_node; // by part
  };
} // namespace tombolo
