// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/contact_surface.h>

#include <memory>

namespace tombolo
{
  /** Declares the section "Contact: NAME" of a contact with a rigid surface. */
  template <int dim>
  void declare_surface_contact(const Entries &e);

  /** Reads the section and refuses what can be seen to be wrong without a mesh. */
  template <int dim>
  void validate_surface_contact(const Section &section, bool has_heat);

  /** The surface that the section names. Throws InputError. */
  template <int dim>
  std::unique_ptr<ContactSurface<dim>> create_surface(const Section &section);
} // namespace tombolo
