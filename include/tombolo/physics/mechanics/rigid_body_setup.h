// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/physics/mechanics/rigid_body.h>

#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /** The owned nodes of the cells of a part, ascending local numbers. */
  template <int dim>
  std::vector<unsigned int> owned_nodes_of_part(const Model<dim> &model, unsigned int part);

  /** The inertia of a rigid part with these owned nodes: that of its cells, and the masses that
   * other parts have at shared nodes. Collective. */
  template <int dim>
  RigidInertia inertia_of_part(const Model<dim> &model, unsigned int part,
                               const std::vector<unsigned int> &nodes);

  /** Refuses scenes in which the nodes of the part, whose section is @p section, cannot move as a
   * rigid body: nodes shared with particles, with cells that can be removed or with another rigid
   * part, nodes that depend on nodes of other parts, conditions and contacts that move its nodes
   * one by one, motion out of a plane of symmetry. Leaves out of @p nodes those that depend on
   * others. Throws InputError. Collective. */
  template <int dim>
  void check_rigid_part(const Section &section, const RigidBodySettings<dim> &motion,
                        const Model<dim> &model, unsigned int part,
                        std::vector<unsigned int> &nodes);
} // namespace tombolo
