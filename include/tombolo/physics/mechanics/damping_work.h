// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/state_archive.h>

#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tombolo
{
  /**
   * What forces on owned nodes take from the motion since the start, of this rank [M L^2/T^2]. The
   * work of the step from t_{n-1} to t_n is that of the forces at both of its ends on v_{n-1/2},
   * half by half, so that each half has the rows of its own time.
   */
  template <int dim>
  class DampingWork
  {
  public:
    using Vector = std::array<double, 3>;

    /** Books the first half of the coming work, with the @p velocity of the rows as they are. */
    void prepare_change(const NodalVector &velocity)
    {
      for (std::size_t i = 0; i < previous_impulse.size(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          dissipated -=
              0.5 * velocity.node(static_cast<unsigned int>(i))[d] * previous_impulse[i][d];
      previous_impulse.clear();
      first_half_is_booked = true;
    }

    /** Books the step that ends at t_n with the @p force of owned nodes there and the @p velocity
     * v_{n-1/2}. */
    void complete_step(const std::vector<Vector> &force, const NodalVector &velocity,
                       const Clock &clock)
    {
      const bool is_start = clock.step == 0;
      // Velocities are given at t_0, so that Δt_0 is half a step; as the beginning of the first
      // interval a force counts whole, like at any other.
      const double as_previous = is_start ? 2. : 1.;
      const bool has_history = !previous_impulse.empty() || first_half_is_booked;
      previous_impulse.resize(force.size());
      for (unsigned int i = 0; i < force.size(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double impulse = clock.velocity_step() * force[i][d];
          if (!is_start)
            dissipated -= 0.5 * velocity.node(i)[d] *
                          (impulse + (has_history ? previous_impulse[i][d] : impulse));
          previous_impulse[i][d] = as_previous * impulse;
        }
      first_half_is_booked = false;
    }

    double sum() const
    {
      return dissipated;
    }

    std::size_t memory_consumption() const
    {
      return previous_impulse.capacity() * sizeof(Vector);
    }

    /** Writes to a checkpoint or reads from it; @p n_owned is the number of owned nodes.
     * Collective. */
    void serialize(StateArchive &archive, const unsigned int n_owned)
    {
      archive.sums("dissipated", {&dissipated});
      std::vector<unsigned int> nodes(n_owned);
      std::iota(nodes.begin(), nodes.end(), 0u);
      archive.nodal("previous impulse", nodes, previous_impulse);
    }

  private:
    std::vector<Vector> previous_impulse; ///< Δt_{n-1} f_{n-1}; empty: that of t_n stands in
    bool first_half_is_booked = false;    ///< of the step in progress; never between two steps
    double dissipated = 0;
  };
} // namespace tombolo
