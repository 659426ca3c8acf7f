// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/spread_loads.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>

#include <algorithm>

// Contacts of the scene with rigid surfaces.
namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void Model<dim>::set_contact_buffers()
  {
    if (contacts.empty())
      return;
    contact_loads.reinit(partition);
    contact_force.reinit(partition);
  }

  template <int dim>
  void Model<dim>::create_contacts(const Parameters &parameters)
  {
    std::vector<bool> can_be_exposed(partition->n_owned(), false);
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        for (const unsigned int node : part.particles->stencils().particle_node)
          can_be_exposed[node] = true;
    // Cells that are removed, and particles that lose bonds, expose nodes of the inside.
    std::vector<types::global_dof_index> cell_nodes;
    if (erodes() || converts())
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (!cell->is_artificial() && (parts[part_cells->part_of(cell)].eroding != nullptr ||
                                       parts[part_cells->part_of(cell)].converting != nullptr))
        {
          nodes->cell_nodes(cell, cell_nodes);
          for (const types::global_dof_index node : cell_nodes)
            if (nodes->owned().is_element(node))
              can_be_exposed[partition->local_index(node)] = true;
        }
    const std::vector<Section> sections = named_sections(parameters, "Contacts", "Contact");
    std::vector<double> volume;
    if (heat && !sections.empty())
    {
      volume.assign(partition->n_owned(), 0.);
      NodalVector mass;
      for (const Part<dim> &part : parts)
      {
        mass.reinit(partition, 1);
        part.formulation->add_mass(mass);
        mass.add_to_owners();
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
          volume[i] += *mass.node(i) / part.material->density();
      }
    }
    for (const Section &section : sections)
      contacts.push_back(std::make_unique<PenaltyContact<dim>>(
          section, mesh, *nodes, state, can_be_exposed, heat != nullptr, volume));
  }

  template <int dim>
  void Model<dim>::compute_contact_force(const Clock &clock)
  {
    nodes_in_contact.clear();
    NodalHeat nodal_heat;
    if (heat)
      nodal_heat = {&heat->state.present_temperature, &heat->nodal_enthalpy, nullptr, nullptr};
    // All see the same heat of a node, whatever their order.
    const bool share_heat =
        heat && contacts.size() > 1 &&
        std::any_of(contacts.begin(), contacts.end(),
                    [](const auto &contact) { return contact->needs_temperature(); });
    const auto sum_of_contacts =
        [&](NodalVector &sum, void (PenaltyContact<dim>::*add)(NodalVector &) const)
    {
      if (sum.partition() != partition)
        sum.reinit(partition, 1);
      sum.set_zero();
      for (const auto &contact : contacts)
        (*contact.*add)(sum);
      return &sum;
    };
    if (share_heat)
      nodal_heat.pending =
          sum_of_contacts(pending_contact_heat, &PenaltyContact<dim>::add_pending_heat);
    for (const auto &contact : contacts)
      contact->add_forces(state, clock, contact_loads, nodes_in_contact, nodal_heat);
    if (share_heat)
    {
      sum_of_contacts(pending_contact_heat, &PenaltyContact<dim>::add_pending_heat);
      nodal_heat.exposure = sum_of_contacts(contact_exposure, &PenaltyContact<dim>::add_exposure);
    }
    if (heat)
      for (const auto &contact : contacts)
        contact->exchange_heat(nodal_heat);
    contact_force.set_zero();
    spread_loads(*bridge, nodes_in_contact, contact_loads, contact_force);
    contact_force.add_to_owners();
  }

  template <int dim>
  ContactBalance Model<dim>::contact_balance() const
  {
    ContactBalance sum;
    for (const auto &contact : contacts)
    {
      const ContactBalance balance = contact->balance(communicator);
      for (unsigned int d = 0; d < 3; ++d)
      {
        sum.force[d] += balance.force[d];
        sum.impulse[d] += balance.impulse[d];
        sum.tool_momentum[d] += balance.tool_momentum[d];
      }
      sum.elastic += balance.elastic;
      sum.friction += balance.friction;
      sum.damping += balance.damping;
      sum.work += balance.work;
      sum.external_work += balance.external_work;
      sum.conducted += balance.conducted;
      sum.heat_of_bodies += balance.heat_of_bodies;
      sum.heat_of_tool += balance.heat_of_tool;
      sum.tool_kinetic += balance.tool_kinetic;
      sum.n_nodes += balance.n_nodes;
      sum.penetration = std::max(sum.penetration, balance.penetration);
    }
    return sum;
  }

  template void Model<2>::set_contact_buffers();
  template void Model<2>::create_contacts(const Parameters &);
  template void Model<2>::compute_contact_force(const Clock &);
  template ContactBalance Model<2>::contact_balance() const;
  template void Model<3>::set_contact_buffers();
  template void Model<3>::create_contacts(const Parameters &);
  template void Model<3>::compute_contact_force(const Clock &);
  template ContactBalance Model<3>::contact_balance() const;
} // namespace tombolo
