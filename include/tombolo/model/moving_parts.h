// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/rigid_cells.h>
#include <tombolo/model/part.h>

namespace tombolo
{
  /** What of the part moves as one rigid body; null where it does not. */
  template <int dim>
  const RigidCells<dim> *rigid_cells(const Part<dim> &part)
  {
    return part.template as<RigidCells>();
  }

  /** Whether the part moves: by its stresses, or as a rigid body. Parts of heat alone do not. */
  template <int dim>
  bool has_motion(const Part<dim> &part)
  {
    return part.material->has_mechanics() || rigid_cells(part) != nullptr;
  }
} // namespace tombolo
