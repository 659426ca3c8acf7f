// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The rigid motions of the bodies of a mesh that nothing holds, in words: "the body with a node
   * at (0, 0, 0) can move along x and turn about z". Empty where all are held. @p constrained is
   * one at components that are held, of owned nodes; @p contacts hold along their normal where they
   * touch. Each body is looked at with its partners at rest, then all that touch as one body.
   * Collective.
   */
  template <int dim>
  std::string free_rigid_modes(const Model<dim> &model, const NodalVector &constrained,
                               const std::vector<ContactStiffness<dim>> &contacts);
} // namespace tombolo
