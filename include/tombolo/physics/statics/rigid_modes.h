// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  constexpr unsigned int n_rigid_modes = dim == 2 ? 3 : 6;

  /** By rigid mode, translations first: what it moves along component @p d at @p arm from the
   * centre. */
  template <int dim>
  std::array<double, 6> rigid_motion_along(const unsigned int d, const std::array<double, 3> &arm)
  {
    std::array<double, 6> result{};
    result[d] = 1.;
    for (unsigned int mode = dim; mode < n_rigid_modes<dim>; ++mode)
    {
      const unsigned int c = dim == 2 ? 2 : mode - dim;
      const unsigned int a = (c + 1) % 3, b = (c + 2) % 3;
      result[mode] = d == a ? -arm[b] : d == b ? arm[a] : 0.;
    }
    return result;
  }

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
