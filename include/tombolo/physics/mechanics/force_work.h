// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** What internal forces at owned nodes take from the motion: the work of the step from t_{n-1} to
   * t_n is -½ (Δt_{n-1} f_{n-1} + Δt_n f_n) · v_{n-1/2}, as the kinetic energy at t_n counts it. */
  class ForceWork
  {
  public:
    /** The forces of a process at t_n: zero at all nodes and ghosts of @p partition. */
    void begin(const std::shared_ptr<const NodePartition> &partition);

    /** Where the process adds its forces, at ghosts too. */
    double *data()
    {
      return force.data();
    }

    /** Collects the forces of ghosts, and adds the sum to @p total at owned nodes. Collective. */
    void add_to(NodalVector &total);

    /** Accounts for the forces at t_{n-1} on the @p velocity of t_{n-1/2}, before nodes or masses
     * change. */
    void close(const NodalVector &velocity);

    /** Accounts for the forces at t_n. */
    void accumulate(const NodalVector &velocity, const Clock &clock);

    /** This rank's share [M L^2/T^2]. */
    double taken() const
    {
      return work;
    }

    std::size_t memory_consumption() const;

    /** Writes or reads, under names that begin with @p name, for the owned nodes of @p partition.
     * Collective. */
    void serialize(const std::string &name, const NodePartition &partition, StateArchive &archive);

  private:
    using Vector = std::array<double, 3>;

    NodalVector force;
    std::vector<Vector> previous_impulse; // Δt_{n-1} f_{n-1}; empty: that of t_n stands in
    bool first_half_is_counted = false;   // of the step in progress; never between two steps
    double work = 0;
  };
} // namespace tombolo
