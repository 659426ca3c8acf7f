// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/static_contacts.h>

#include <tombolo/contact/contact_settings.h>
#include <tombolo/model/model_input.h>
#include <tombolo/physics/mechanics/courant_limit.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  StaticContacts<dim>::StaticContacts(Model<dim> &model) : model(model)
  {
    for (const auto &process : model.processes)
      if (auto *const contact = dynamic_cast<StaticProcess<dim> *>(process.get()))
        members.push_back(contact);
  }

  template <int dim>
  void StaticContacts<dim>::refuse_unfit(const Parameters &parameters, const std::string &method)
  {
    const std::string steps = "`" + method + "` steps (entry \"Time integration\") have none; ";
    for (const auto &[list, kind] :
         {std::make_pair("Contacts", "Contact"), std::make_pair("Body contacts", "Body contact")})
      for (const Section &section : named_sections(parameters, list, kind))
        parameters.attempt(
            [&]
            {
              if (section.is_set("Damping") && section.get_double("Damping") > 0.)
                section.fail("Damping", "it resists the speed of approach, and " + steps +
                                            "allowed is 0, or no such entry.");
            });
    for (const Section &section : named_sections(parameters, "Contacts", "Contact"))
      parameters.attempt(
          [&]
          {
            if (section.get("Method") == "kinematic")
              section.fail("Method", "nodes are put onto the surface by accelerations, and " +
                                         steps + "allowed is penalty or surface.");
            const std::string surface = section.get("Surface");
            if (surface == surface_of_part)
              section.fail("Surface", "springs between nodes and a part act on several nodes of "
                                      "it, and `" +
                                          method +
                                          "` steps (entry \"Time integration\") do not know their "
                                          "stiffness; allowed is another surface, or a body "
                                          "contact.");
            if (const Section of_surface = section.subsection(surface);
                of_surface.is_set("Mass") && !of_surface.get("Mass").empty())
              of_surface.fail("Mass", "a surface with a mass is moved by accelerations, and " +
                                          steps + "allowed is a `Displacement`.");
          });
  }

  template <int dim>
  void StaticContacts<dim>::become_static(const double factor)
  {
    if (members.empty())
      return;
    time_of_springs = round_down(courant_limit(model).time_step) / std::sqrt(factor);
    double extent = 0;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        extent = std::max(extent, std::abs(model.state.initial_position.node(i)[d]));
    // As in refuse_penetration(): what round-off has put apart touches.
    const double tolerance = 1e-9 * Utilities::MPI::max(extent, model.communicator);
    for (StaticProcess<dim> *const contact : members)
      contact->become_static(tolerance);
  }

  template <int dim>
  void StaticContacts<dim>::begin_trial(const Clock &clock)
  {
    for (StaticProcess<dim> *const contact : members)
      contact->begin_trial(model, clock);
  }

  template <int dim>
  void StaticContacts<dim>::restart_trial()
  {
    for (StaticProcess<dim> *const contact : members)
      contact->restart_trial();
  }

  template <int dim>
  std::vector<ContactStiffness<dim>> StaticContacts<dim>::stiffness(const Clock &clock) const
  {
    std::vector<ContactStiffness<dim>> result;
    for (StaticProcess<dim> *const contact : members)
      contact->find_stiffness(model, clock, result);
    return result;
  }

  template <int dim>
  std::vector<ContactStiffness<dim>> StaticContacts<dim>::stiffness_at_start()
  {
    if (members.empty())
      return {};
    Clock clock;
    clock.stable_step = time_of_springs;
    begin_trial(clock);
    NodalVector force;
    force.reinit(model.state.partition());
    for (const auto &process : model.processes)
      if (dynamic_cast<const StaticProcess<dim> *>(process.get()) != nullptr)
        process->act(model, clock, force);
    std::vector<ContactStiffness<dim>> result = stiffness(clock);
    restart_trial();
    return result;
  }

  template <int dim>
  void StaticContacts<dim>::add_stiffness_bound(const Clock &clock, NodalVector &sums) const
  {
    for (StaticProcess<dim> *const contact : members)
      contact->add_stiffness_bound(model, clock, sums);
  }

  template class StaticContacts<2>;
  template class StaticContacts<3>;
} // namespace tombolo
