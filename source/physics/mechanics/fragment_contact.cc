// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/fragment_contact.h>

#include <tombolo/model/process.h>
#include <tombolo/physics/statics/rest_entries.h>

namespace tombolo
{
  template <int dim>
  void FragmentContact<dim>::validate(const Parameters &parameters,
                                      const std::vector<Part<dim>> &parts)
  {
    refuse_switch_at_rest<dim>(parameters, parts, "Self-contact",
                               "it acts between fragments that move");
  }

  TOMBOLO_REGISTER_PROCESS(FragmentContact, process_order::fragment_contact)
} // namespace tombolo
