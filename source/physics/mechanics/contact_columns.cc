// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/contact_columns.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/rigid_contacts.h>

namespace tombolo
{
  template <int dim>
  void RigidContacts<dim>::show(const Model<dim> &model)
  {
    for (const auto &contact : members)
      this->observed.object(*contact);
    this->observed.history(
        contact_history,
        [this, &model](BalanceHistory<dim> &row)
        {
          for (const auto &contact : members)
          {
            const ContactBalance now = contact->balance(communicator);
            add_contact_columns(now, contact.get(), contact->has_areas(), contact->conducts(), row);
            if (model.heat)
              add_temperatures("contact",
                               mean_and_largest(model.heat->state.present_temperature,
                                                contact->nodes_in_contact()),
                               row);
            if (contact->is_with_part() && contact->conducts())
              add_temperatures("part", contact->temperatures_of_part(), row);
          }
        });
    this->observed.views.connect(
        [this](OutputView<dim> &view)
        {
          for (const auto &contact : members)
          {
            const auto act = [this, &contact]
            {
              const ContactBalance balance = contact->balance(communicator);
              return std::make_pair(balance.force, balance.penetration);
            };
            view.surfaces.push_back({contact->name(), &contact->contact_surface(), act});
            view.nodal_forces[contact_force].emplace_back([&contact](NodalVector &force)
                                                          { contact->add_present_forces(force); });
          }
        });
  }

  template void RigidContacts<2>::show(const Model<2> &);
  template void RigidContacts<3>::show(const Model<3> &);

  namespace
  {
    /** `contact.csv` (doc/contact.md). Of a contact between bodies the force is that on the slave,
     * conducted heat is that into the slave, and there is no surface. */
    const HistoryRegistration
        contact_registration({contact_history, "contact.csv",
                              "Forces, impulses, heat and penetration of contacts (contact.csv); "
                              "in every scene that has contacts.",
                              true, false, "contact", "penetration"},
                             2, "the entries Contacts and Body contacts",
                             [](const Section &output)
                             {
                               return !output.all().raw_list("Contacts").empty() ||
                                      !output.all().raw_list("Body contacts").empty();
                             });
  } // namespace
} // namespace tombolo
