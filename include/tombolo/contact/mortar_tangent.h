// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/contact/mortar_contact.h>

#include <vector>

namespace tombolo
{
  /** Adds how the forces of the last evaluation change with positions, with the depth that motion
   * along the surfaces changes where they are inclined to each other. Left out is what changes of
   * weights and normals do to the direction and the place of the forces: smaller by the ratio of
   * pressure and stiffness of the bodies. Collective. */
  template <int dim>
  void add_mortar_stiffness(const MortarContact<dim> &contact, const NodalVector &position,
                            std::vector<ContactStiffness<dim>> &result);
} // namespace tombolo
