// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/state/nodal_vector.h>

#include <cmath>
#include <vector>

namespace tombolo
{
  template <int dim>
  class BodyPoint;

  /**
   * How forces of processes change with positions and velocities, what Process::linearize() adds
   * to: members that are null are not needed. The stiffness is that of steps of bodies at rest,
   * which is assembled; the viscosity that of the estimate of the stable step, which applies it to
   * one velocity after the other.
   */
  template <int dim>
  struct Tangent
  {
    /** Pairs of nodes, with nodes that this rank owns; each pair is on one rank. */
    std::vector<ContactStiffness<dim>> *springs = nullptr;
    /** A bound of the stiffness whatever touches, as a diagonal matrix, at owned nodes. */
    NodalVector *bound = nullptr;

    /** @p factor C @p velocity is to be added to @p force at owned nodes, where forces are -C v.
     * Ghosts of the velocity are current. */
    const NodalVector *velocity = nullptr;
    double factor = 0;
    NodalVector *force = nullptr;

    /** A spring between an owned node and a point outside of the bodies: -∂f/∂x is the symmetric
     * @p stiffness [M/T^2], which is not zero, but may be so in some directions, as across a cord:
     * then it holds a body along the others only. */
    void add_spring(const unsigned int node, const dealii::Tensor<2, dim> &stiffness)
    {
      if (springs == nullptr)
        return;
      add_bound(node, stiffness);
      push_spring(node, {{bound->partition()->global_index(node), {}, 1.}}, stiffness);
    }

    /** The same with @p stiffness in all directions. */
    void add_spring(const unsigned int node, const double stiffness)
    {
      dealii::Tensor<2, dim> in_all_directions;
      for (unsigned int d = 0; d < dim; ++d)
        in_all_directions[d][d] = stiffness;
      add_spring(node, in_all_directions);
    }

    /** The same between two points of bodies. Collective. */
    void add_spring(const BodyPoint<dim> &first, const BodyPoint<dim> &second,
                    const dealii::Tensor<2, dim> &stiffness)
    {
      if (springs == nullptr)
        return;
      const NodePartition &partition = *bound->partition();
      const auto node = first.global_node(partition), other = second.global_node(partition);
      for (const BodyPoint<dim> *const point : {&first, &second})
        if (point->is_here())
          add_bound(point->node(), stiffness);
      if (first.is_here())
        push_spring(first.node(), {{node, {}, 1.}, {other, {}, -1.}}, stiffness);
    }

    void add_bound(const unsigned int node, const double stiffness)
    {
      for (unsigned int d = 0; d < dim && bound != nullptr; ++d)
        bound->node(node)[d] += stiffness;
    }

  private:
    void add_bound(const unsigned int node, const dealii::Tensor<2, dim> &stiffness)
    {
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e < dim; ++e)
          bound->node(node)[d] += std::abs(stiffness[d][e]);
    }

    void push_spring(const unsigned int node,
                     const typename ContactStiffness<dim>::Entries &entries,
                     const dealii::Tensor<2, dim> &stiffness)
    {
      ContactStiffness<dim> spring;
      spring.node = node;
      spring.entries = entries;
      spring.along = stiffness;
      spring.is_tied = determinant(stiffness) > 0.;
      unsigned int stiffest = 0;
      for (unsigned int d = 0; d < dim; ++d)
        stiffest = stiffness[d][d] > stiffness[stiffest][stiffest] ? d : stiffest;
      spring.direction = stiffness[stiffest] / stiffness[stiffest].norm();
      springs->push_back(spring);
    }
  };
} // namespace tombolo
