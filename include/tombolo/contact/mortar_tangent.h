// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/contact/mortar_contact.h>

#include <vector>

namespace tombolo
{
  /** Adds how the forces of the last evaluation change with positions, at fixed weights and
   * normals: what these change is smaller by the ratio of pressure and stiffness of the bodies.
   * Collective. */
  template <int dim>
  void add_mortar_stiffness(const MortarContact<dim> &contact,
                            const std::shared_ptr<const NodePartition> &partition,
                            std::vector<ContactStiffness<dim>> &result);
} // namespace tombolo
