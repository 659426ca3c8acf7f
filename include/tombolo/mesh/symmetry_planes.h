// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/symmetry.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** Whether the section of a condition is one of symmetry. */
  bool is_symmetry(const Section &condition);

  /** Refuses what can be seen to be wrong without a mesh. */
  template <int dim>
  void validate_symmetry(const Section &condition);

  /**
   * The planes that the conditions of type `symmetry` of a @p scene name. `Boundary` or `Where` of
   * each must select all nodes on one plane normal to an axis, and the body must not reach beyond
   * it. Two planes can have the same axis: the body is then the slab between them. Null if there
   * are none. Throws InputError. Collective.
   */
  template <int dim>
  std::shared_ptr<const Symmetry> find_symmetry(const Parameters &scene, const Mesh<dim> &mesh,
                                                const Nodes<dim> &nodes);
} // namespace tombolo
