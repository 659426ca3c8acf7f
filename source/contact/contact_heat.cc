// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_heat.h>

#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <numeric>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ContactHeat<dim>::ContactHeat(const Section &section, const ContactSettings &settings,
                                const std::vector<unsigned int> &candidates,
                                PartSurface<dim> *const surface)
      : settings(settings), candidates(candidates), pending(candidates.size(), 0.)
  {
    if (surface != nullptr)
      part = std::make_unique<PartHeat<dim>>(section, *surface);
    else
      tool = ToolHeat<dim>::create(section);
  }

  template <int dim>
  void ContactHeat<dim>::begin_step(const NodalHeat &nodal_heat)
  {
    friction_of_tool = 0.;
    if (HeatPartner *const other = partner())
      other->begin_step();
    if (part && settings.splits_by_effusivity)
      part->find_effusivities(nodal_heat);
  }

  template <int dim>
  double ContactHeat<dim>::enthalpy(const std::size_t candidate, const NodalHeat &nodal_heat) const
  {
    const unsigned int node = candidates[candidate];
    return nodal_heat.enthalpy->enthalpy(node, *nodal_heat.temperature->node(node)) +
           (nodal_heat.pending != nullptr ? *nodal_heat.pending->node(node) : pending[candidate]);
  }

  template <int dim>
  double ContactHeat<dim>::temperature(const std::size_t candidate,
                                       const NodalHeat &nodal_heat) const
  {
    return nodal_heat.enthalpy->temperature(candidates[candidate], enthalpy(candidate, nodal_heat));
  }

  template <int dim>
  void ContactHeat<dim>::add_friction(const std::size_t candidate, const double heat,
                                      const NodalHeat &nodal_heat)
  {
    double fraction = settings.heat_fraction;
    if (settings.splits_by_effusivity && heat != 0.)
    {
      const double of_node = temperature(candidate, nodal_heat);
      const double of_body = nodal_heat.enthalpy->effusivity(candidates[candidate], of_node);
      const double of_other =
          part ? part->effusivity(candidate)
               : settings.tool_effusivity.value(tool ? tool->temperature() : of_node);
      fraction = of_body / (of_body + of_other);
      friction_of_bodies += fraction * heat;
      friction_of_tool += (1. - fraction) * heat;
    }
    pending[candidate] += fraction * heat;
    if (part && heat != 0.)
      part->add_friction(candidate, (1. - fraction) * heat);
  }

  template <int dim>
  void ContactHeat<dim>::end_forces(const double heat)
  {
    if (!settings.splits_by_effusivity)
      friction_of_tool = (1. - settings.heat_fraction) * heat;
  }

  template <int dim>
  void ContactHeat<dim>::exchange(const NodalHeat &nodal_heat, const MPI_Comm communicator)
  {
    if (HeatPartner *const other = partner())
      other->end_step(
          friction_of_tool, nodal_heat,
          [&](const std::size_t k) { return enthalpy(k, nodal_heat); }, pending, communicator);
  }

  template <int dim>
  void ContactHeat<dim>::add_pending_heat(NodalVector &heat) const
  {
    for (std::size_t k = 0; k < pending.size(); ++k)
      heat.node(candidates[k])[0] += pending[k];
    if (part)
      part->add_pending_heat(heat);
  }

  template <int dim>
  void ContactHeat<dim>::forget_pending_heat()
  {
    std::fill(pending.begin(), pending.end(), 0.);
    if (part)
      part->forget_pending_heat();
  }

  template <int dim>
  double ContactHeat<dim>::heat_to_give() const
  {
    return std::accumulate(pending.begin(), pending.end(), 0.) + (part ? part->heat_to_give() : 0.);
  }

  template <int dim>
  void ContactHeat<dim>::add_shares(ContactBalance &shares) const
  {
    shares.conducted = partner() != nullptr ? partner()->conducted() : 0.;
    shares.friction_of_bodies = friction_of_bodies;
  }

  template <int dim>
  void ContactHeat<dim>::complete(ContactBalance &sums) const
  {
    if (!settings.splits_by_effusivity)
      sums.friction_of_bodies = settings.heat_fraction * sums.friction;
    sums.heat_of_bodies = sums.friction_of_bodies + sums.conducted;
    sums.heat_of_tool =
        tool && tool->has_capacity() ? tool->stored() : sums.friction - sums.heat_of_bodies;
    sums.tool_temperature = tool ? tool->temperature() : 0.;
  }

  template <int dim>
  typename ContactHeat<dim>::State ContactHeat<dim>::state() const
  {
    return {pending, friction_of_bodies,
            tool ? tool->state() : typename ToolHeat<dim>::State{0., 0.}};
  }

  template <int dim>
  void ContactHeat<dim>::restore(const State &state)
  {
    pending = std::get<0>(state);
    friction_of_bodies = std::get<1>(state);
    if (tool)
      tool->restore(std::get<2>(state));
  }

  template <int dim>
  void ContactHeat<dim>::serialize_pending(StateArchive &archive)
  {
    std::vector<std::array<double, 3>> heat;
    for (const double value : pending)
      heat.push_back({{value, 0., 0.}});
    archive.nodal("heat to give", candidates, heat);
    for (std::size_t k = 0; k < pending.size(); ++k)
      pending[k] = heat[k][0];
  }

  template <int dim>
  void ContactHeat<dim>::serialize(StateArchive &archive)
  {
    if (settings.splits_by_effusivity)
      archive.sums("friction heat of bodies", {&friction_of_bodies});
    if (tool)
      tool->serialize(archive);
    if (part)
      part->serialize(archive);
    serialize_pending(archive);
  }

  template <int dim>
  void ContactHeat<dim>::continue_from(StateArchive &archive)
  {
    if (part)
      part->continue_from(archive);
    if (archive.has("heat to give"))
      serialize_pending(archive);
  }

  template class ContactHeat<2>;
  template class ContactHeat<3>;
} // namespace tombolo
