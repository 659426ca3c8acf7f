// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/part_surface.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /** Refuses what can be seen without a mesh to be wrong with the part that a contact with `Surface
   * = part` names. */
  template <int dim>
  void validate_master_part(const Section &contact, const std::vector<Part<dim>> &parts);

  /** The part that a contact with `Surface = part` names; nothing for other surfaces. Throws
   * InputError where it cannot be touched. Collective. */
  template <int dim>
  MasterPart<dim> master_part(const Section &contact, const Model<dim> &model);
} // namespace tombolo
