// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <string>

namespace tombolo
{
  /**
   * The rigid motions of the bodies of a mesh that nothing holds, in words: "the body with a node
   * at (0, 0, 0) can move along x and turn about z". Empty where all are held. @p constrained is
   * one at components that are held, of owned nodes. Collective.
   */
  template <int dim>
  std::string free_rigid_modes(const Model<dim> &model, const NodalVector &constrained);
} // namespace tombolo
