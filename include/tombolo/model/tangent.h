// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /**
   * How forces of processes change with positions and velocities, what Process::linearize() adds
   * to: members that are null are not asked for. The stiffness is that of steps of bodies at rest,
   * which is assembled; the viscosity that of the estimate of the stable step, which applies it to
   * one velocity after the other.
   */
  template <int dim>
  struct Tangent
  {
    /** Pairs of nodes, with nodes that this rank owns; each place stands on one rank. */
    std::vector<ContactStiffness<dim>> *springs = nullptr;
    /** A bound of the stiffness whatever touches, as a diagonal matrix, at owned nodes. */
    NodalVector *bound = nullptr;

    /** @p factor C @p velocity is to be added to @p force at owned nodes, where forces are -C v.
     * Ghosts of the velocity are current. */
    const NodalVector *velocity = nullptr;
    double factor = 0;
    NodalVector *force = nullptr;

    /** A spring between an owned node and a place outside of the bodies: -∂f/∂x is @p stiffness in
     * all directions [M/T^2]. */
    void add_spring(const unsigned int node, const double stiffness)
    {
      if (springs == nullptr)
        return;
      ContactStiffness<dim> spring;
      spring.node = node;
      spring.entries.push_back({bound->partition()->global_index(node), {}, 1.});
      for (unsigned int d = 0; d < dim; ++d)
        spring.along[d][d] = stiffness;
      spring.direction[0] = 1.;
      spring.is_tied = true;
      springs->push_back(spring);
      add_bound(node, stiffness);
    }

    void add_bound(const unsigned int node, const double stiffness)
    {
      for (unsigned int d = 0; d < dim && bound != nullptr; ++d)
        bound->node(node)[d] += stiffness;
    }
  };
} // namespace tombolo
