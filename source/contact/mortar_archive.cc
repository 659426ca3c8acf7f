// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_contact.h>

#include <tombolo/state/state_archive.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MortarContact<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("body contact " + contact_name);
    stiffness.serialize(archive, slaves, masters);
    archive.sums("heat, work and impulse", totals.shares());
    NodeHistory::serialize(archive, slaves.owned_nodes(), histories);
  }

  template <int dim>
  void MortarContact<dim>::continue_from(StateArchive &archive)
  {
    if (settings.is_tied || !archive.has("body contact " + contact_name))
      return;
    serialize(archive);
    stiffness.forget_masses();
    totals = MortarTotals<dim>();
  }

  template void MortarContact<2>::serialize(StateArchive &);
  template void MortarContact<3>::serialize(StateArchive &);
  template void MortarContact<2>::continue_from(StateArchive &);
  template void MortarContact<3>::continue_from(StateArchive &);
} // namespace tombolo
