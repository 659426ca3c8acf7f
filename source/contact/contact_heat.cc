// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_heat.h>

#include <tombolo/contact/mean_and_largest.h>
#include <tombolo/contact/tool_heat.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  PartHeat<dim>::PartHeat(const Section &section, PartSurface<dim> &surface)
      : HeatPartner(ToolHeat<dim>::read_conductance(section)), surface(surface)
  {
    for (const char *const entry : {"Tool temperature", "Heat capacity", "Tool effusivity"})
      if (section.is_set(entry))
        section.fail(entry, "the surface is that of a part, which has nodes with temperatures and "
                            "a material of its own; allowed is no such entry.");
    incoming.assign(surface.nodes_of_part().n_nodes(), 0.);
  }

  template <int dim>
  std::vector<double>
  PartHeat<dim>::gather(const NodalHeat &nodal_heat, const unsigned int n_values,
                        const std::function<void(unsigned int, double, double *)> &write) const
  {
    return surface.nodes_of_part().gather(
        n_values, Quantity::scalars,
        [&](const unsigned int node, double *const values)
        {
          const bool has_got = *nodal_heat.pending->node(node) != 0.;
          write(node,
                has_got ? nodal_heat.temperature_of(node) : *nodal_heat.temperature->node(node),
                values);
        });
  }

  template <int dim>
  void PartHeat<dim>::find_effusivities(const NodalHeat &nodal_heat)
  {
    effusivities = gather(nodal_heat, 1,
                          [&](const unsigned int node, const double temperature, double *const e)
                          { *e = nodal_heat.enthalpy->effusivity(node, temperature); });
  }

  template <int dim>
  double PartHeat<dim>::effusivity(const std::size_t candidate) const
  {
    const auto &place = surface.place(candidate);
    double result = 0;
    for (unsigned int c = 0; c < place.weights.size(); ++c)
      result += place.weights[c] * effusivities[surface.cell(place)[c]];
    return result;
  }

  template <int dim>
  void PartHeat<dim>::add_friction(const std::size_t candidate, const double heat)
  {
    const auto &place = surface.place(candidate);
    for (unsigned int c = 0; c < place.weights.size(); ++c)
      incoming[surface.cell(place)[c]] += place.weights[c] * heat;
  }

  template <int dim>
  void PartHeat<dim>::end_step(const double /*friction*/, const NodalHeat &nodal_heat,
                               const MPI_Comm /*communicator*/)
  {
    const PartLayer<dim> &layer = surface.nodes_of_part();
    if (conducts())
    {
      const NodalEnthalpy &of_nodes = *nodal_heat.enthalpy;
      const std::vector<double> of_part =
          gather(nodal_heat, 2,
                 [&](const unsigned int node, const double temperature, double *const values)
                 {
                   values[0] = temperature;
                   values[1] = of_nodes.capacity(node, temperature);
                 });
      std::vector<double> capacities(layer.n_nodes());
      for (std::size_t a = 0; a < capacities.size(); ++a)
        capacities[a] = of_part[2 * a + 1];
      std::vector<const typename PartSurface<dim>::Place *> places;
      std::vector<double> of_touch, temperatures;
      temperatures_below.clear();
      for (const Touch &touch : touches)
      {
        const auto &place = surface.place(touch.candidate);
        double below = 0;
        for (unsigned int c = 0; c < place.weights.size(); ++c)
          below += place.weights[c] * of_part[2 * surface.cell(place)[c]];
        const double of_node = nodal_heat.enthalpy_of(touch.node);
        const double temperature = of_nodes.temperature(touch.node, of_node);
        places.push_back(&place);
        temperatures.push_back(temperature);
        temperatures_below.push_back(below);
        of_touch.push_back(mean_capacity(of_nodes, touch.node, of_node, temperature, below));
      }
      const std::vector<double> crowding = surface.crowding(places, of_touch, capacities);
      for (std::size_t i = 0; i < touches.size(); ++i)
      {
        const double received = response(touches[i], nodal_heat, of_touch[i] / (1. + crowding[i])) *
                                (temperatures_below[i] - temperatures[i]);
        nodal_heat.conduction->add(touches[i].node, received);
        conducted_heat += received;
        for (unsigned int c = 0; c < places[i]->weights.size(); ++c)
          incoming[surface.cell(*places[i])[c]] -= places[i]->weights[c] * received;
      }
    }
    layer.sum(1, Quantity::scalar, incoming);
    for (const auto &owned : layer.owned())
      nodal_heat.conduction->add(owned.node, incoming[owned.number]);
    std::fill(incoming.begin(), incoming.end(), 0.);
  }

  template <int dim>
  std::array<double, 2> PartHeat<dim>::temperatures_in_contact(const MPI_Comm communicator) const
  {
    return mean_and_largest(temperatures_below, communicator);
  }

  template class PartHeat<2>;
  template class PartHeat<3>;

  template <int dim>
  ContactHeat<dim>::ContactHeat(const Section &section, const ContactSettings &settings,
                                const std::vector<unsigned int> &candidates,
                                PartSurface<dim> *const surface)
      : settings(settings), candidates(candidates)
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
  void ContactHeat<dim>::add_friction(const std::size_t candidate, const double heat,
                                      const NodalHeat &nodal_heat)
  {
    if (heat == 0.)
      return;
    double fraction = settings.heat_fraction;
    if (settings.splits_by_effusivity)
    {
      const double of_node = nodal_heat.temperature_of(candidates[candidate]);
      const double of_body = nodal_heat.enthalpy->effusivity(candidates[candidate], of_node);
      const double of_other =
          part ? part->effusivity(candidate)
               : settings.tool_effusivity.value(tool ? tool->temperature() : of_node);
      fraction = of_body / (of_body + of_other);
      friction_of_bodies += fraction * heat;
      friction_of_tool += (1. - fraction) * heat;
    }
    nodal_heat.friction->add(candidates[candidate], fraction * heat);
    if (part)
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
      other->end_step(friction_of_tool, nodal_heat, communicator);
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

  template class ContactHeat<2>;
  template class ContactHeat<3>;
} // namespace tombolo
