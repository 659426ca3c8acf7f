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

  /** A rigid body: the parts of cells that common nodes join, the first of which is the one whose
   * section gives the motion, and their owned nodes, ascending local numbers. */
  struct JoinedParts
  {
    std::vector<unsigned int> parts, nodes;
  };

  /** The rigid bodies of a model, whose parts have the sections @p sections. Throws the InputError
   * of a body whose motion two parts give. Collective. */
  template <int dim>
  std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &sections,
                                             const Model<dim> &model);

  /** The inertia of a body: that of its cells, and the masses that other parts have at shared
   * nodes. Collective. */
  template <int dim>
  RigidInertia inertia_of(const JoinedParts &body, const Model<dim> &model);

  /** Refuses scenes in which the nodes of a body, whose section is @p section, cannot move as a
   * rigid body: nodes shared with particles or cells that become such, nodes that depend on nodes
   * of other parts, conditions and contacts that move its nodes one by one, motion out of a plane
   * of symmetry. Leaves out of @p body the nodes that depend on others. Throws InputError.
   * Collective.
   */
  template <int dim>
  void check_rigid_body(const Section &section, const RigidBodySettings<dim> &motion,
                        const Model<dim> &model, JoinedParts &body);
} // namespace tombolo
