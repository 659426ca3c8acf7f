// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_heat.h>

#include <tombolo/base/ordered_sum.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  HeatPartner::HeatPartner(const Entries &e, const bool is_part) : is_part(is_part)
  {
    conductance = e.object<TemperatureTable>(
        "Conductance", "0", "M/(T^3 temperature)",
        "h of the heat h (tool temperature - temperature) that enters the body per area in "
        "contact and time: one number, or pairs `pressure: value` separated by commas, joined "
        "by straight lines. 0: nothing is conducted. Only in scenes with heat.",
        "pressure");
    e.refuse(conductance.smallest() < 0., "Conductance", "allowed are numbers from zero on.");
    if (!e.when(!is_part))
      return;
    const auto read_temperature = [&]
    {
      initial_temperature = e.number(
          "Tool temperature", mandatory, any_number(), "temperature",
          "The temperature of the tool, at the start where it has a `Heat capacity`. Needed for "
          "a tool that conducts or has one.");
    };
    if (e.declares()) // before what decides whether it is read
      read_temperature();
    capacity = e.number(
        "Heat capacity", "0", any_number(), "M L^2/(T^2 temperature)",
        "Of the whole tool, whose temperature then changes by its share of the heat of "
        "friction and by what it conducts; 0 for a tool that keeps its temperature. Only in "
        "scenes with heat.");
    e.refuse(!(capacity >= 0.), "Heat capacity", "allowed is zero or a positive number.");
    if (!e.declares() && has_temperature())
      read_temperature();
  }

  template <int dim>
  ContactHeat<dim>::ContactHeat(const Section &section, const ContactSettings &settings,
                                const std::vector<unsigned int> &candidates,
                                PartSurface<dim> *const surface)
      : settings(settings), candidates(candidates), surface(surface),
        partner(section, surface != nullptr), tool_temperature(partner.initial_temperature)
  {
    if (surface == nullptr)
      return;
    for (const char *const entry : {"Tool temperature", "Heat capacity", "Tool effusivity"})
      if (section.is_set(entry))
        section.fail(entry, "the surface is that of a part, which has nodes with temperatures and "
                            "a material of its own; allowed is no such entry.");
    incoming.assign(surface->nodes_of_part().n_nodes(), 0.);
  }

  template <int dim>
  void ContactHeat<dim>::list(Records &records)
  {
    if (settings.splits_by_effusivity)
      records.sums("friction heat of bodies", friction_of_bodies);
    if (surface != nullptr)
      records.group("heat of the part").sums("conducted", conducted);
    else if (partner.has_temperature())
    {
      Records &tool_records = records.group("heat of the tool");
      tool_records.value("temperature", tool_temperature);
      tool_records.sums("conducted", conducted);
    }
  }

  template <int dim>
  std::vector<double>
  ContactHeat<dim>::gather(const NodalHeat &nodal_heat, const unsigned int n_values,
                           const std::function<void(unsigned int, double, double *)> &write) const
  {
    return surface->nodes_of_part().gather(
        n_values, Quantity::scalars,
        [&](const unsigned int node, double *const values)
        { write(node, nodal_heat.present_temperature(node), values); });
  }

  template <int dim>
  double ContactHeat<dim>::value_at(const std::size_t candidate,
                                    const std::vector<double> &node_values,
                                    const unsigned int stride) const
  {
    const auto &contact_point = surface->contact_point(candidate);
    double result = 0;
    for (unsigned int c = 0; c < contact_point.weights.size(); ++c)
      result += contact_point.weights[c] * node_values[stride * surface->cell(contact_point)[c]];
    return result;
  }

  template <int dim>
  void ContactHeat<dim>::begin_step(const NodalHeat &nodal_heat)
  {
    friction_of_tool = 0.;
    touches.clear();
    if (surface != nullptr && settings.splits_by_effusivity)
      effusivities = gather(nodal_heat, 1,
                            [&](const unsigned int node, const double temperature, double *const e)
                            { *e = nodal_heat.enthalpy->effusivity(node, temperature); });
  }

  template <int dim>
  double ContactHeat<dim>::share_of_body(const std::size_t candidate,
                                         const NodalHeat &nodal_heat) const
  {
    if (!settings.splits_by_effusivity)
      return settings.heat_fraction;
    const double node_temperature = nodal_heat.temperature_of(candidates[candidate]);
    const double body_effusivity =
        nodal_heat.enthalpy->effusivity(candidates[candidate], node_temperature);
    const double other_effusivity =
        surface != nullptr ? value_at(candidate, effusivities)
                           : settings.tool_effusivity.value(
                                 partner.has_temperature() ? tool_temperature : node_temperature);
    return body_effusivity / (body_effusivity + other_effusivity);
  }

  template <int dim>
  double ContactHeat<dim>::add_friction(const std::size_t candidate, const double heat,
                                        const NodalHeat &nodal_heat)
  {
    if (heat == 0.)
      return 0.;
    const double fraction = share_of_body(candidate, nodal_heat);
    if (settings.splits_by_effusivity)
    {
      friction_of_bodies += fraction * heat;
      friction_of_tool += (1. - fraction) * heat;
    }
    nodal_heat.friction->add(candidates[candidate], fraction * heat);
    if (surface != nullptr)
      add_to_part(candidate, (1. - fraction) * heat);
    return fraction * heat;
  }

  template <int dim>
  void ContactHeat<dim>::find_capacities(const NodalHeat &nodal_heat,
                                         const std::vector<double> &temperatures,
                                         std::vector<double> &capacities)
  {
    const NodalEnthalpy &enthalpy = *nodal_heat.enthalpy;
    std::vector<double> part_values;
    if (surface != nullptr)
      part_values =
          gather(nodal_heat, 2,
                 [&](const unsigned int node, const double temperature, double *const values)
                 {
                   values[0] = temperature;
                   values[1] = enthalpy.capacity(node, temperature);
                 });
    below.assign(touches.size(), tool_temperature);
    for (std::size_t i = 0; i < touches.size(); ++i)
    {
      const unsigned int node = touches[i].node;
      if (surface != nullptr)
        below[i] = value_at(touches[i].candidate, part_values, 2);
      const double mean = (enthalpy.enthalpy(node, below[i]) - nodal_heat.enthalpy_of(node)) /
                          (below[i] - temperatures[i]);
      // The mean is all round-off where the temperatures are alike.
      capacities.push_back(!enthalpy.is_linear() && mean > 0. && std::isfinite(mean)
                               ? mean
                               : enthalpy.capacity(node, temperatures[i]));
    }
    if (surface == nullptr)
      return;
    std::vector<std::size_t> touching;
    for (const Touch &touch : touches)
      touching.push_back(touch.candidate);
    const std::vector<double> crowding = surface->crowding(
        touching, capacities, [&](const unsigned int a) { return part_values[2 * a + 1]; });
    for (std::size_t i = 0; i < touches.size(); ++i)
      capacities[i] /= 1. + crowding[i];
  }

  template <int dim>
  void ContactHeat<dim>::exchange(const NodalHeat &nodal_heat, const MPI_Comm communicator)
  {
    if (!partner.has_temperature())
      return;
    temperatures.clear();
    responses.clear();
    for (const Touch &touch : touches)
      temperatures.push_back(nodal_heat.temperature_of(touch.node));
    if (conducts())
      find_capacities(nodal_heat, temperatures, responses);
    // a_i, of which each of several surfaces has its share.
    for (std::size_t i = 0; i < touches.size(); ++i)
    {
      const double exposure = nodal_heat.exposure != nullptr
                                  ? *nodal_heat.exposure->node(touches[i].node)
                                  : touches[i].exposure;
      const double share = exposure > 0. ? touches[i].exposure / exposure : 1.;
      responses[i] = share * (-responses[i] * std::expm1(-exposure / responses[i]));
    }
    if (partner.capacity > 0.)
    {
      // Differences to the temperature before, so that a tool that nothing heats keeps it exactly.
      std::array<double, 2> sums{{friction_of_tool, 0.}};
      for (std::size_t i = 0; i < touches.size(); ++i)
      {
        sums[0] -= responses[i] * (tool_temperature - temperatures[i]);
        sums[1] += responses[i];
      }
      sums = ordered_sum(sums, communicator);
      tool_temperature += sums[0] / (partner.capacity + sums[1]);
      below.assign(touches.size(), tool_temperature);
    }
    for (std::size_t i = 0; i < touches.size(); ++i)
    {
      const double received = responses[i] * (below[i] - temperatures[i]);
      nodal_heat.conduction->add(touches[i].node, received);
      conducted += received;
      if (surface != nullptr)
        add_to_part(touches[i].candidate, -received);
    }
    if (surface == nullptr)
      return;
    const PartLayer<dim> &layer = surface->nodes_of_part();
    layer.sum(1, Quantity::scalar, incoming);
    for (const auto &owned : layer.owned())
      nodal_heat.conduction->add(owned.node, incoming[owned.number]);
    std::fill(incoming.begin(), incoming.end(), 0.);
  }

  template <int dim>
  void ContactHeat<dim>::complete(ContactBalance &sums) const
  {
    if (!settings.splits_by_effusivity)
      sums.friction_of_bodies = settings.heat_fraction * sums.friction;
    sums.heat_of_bodies = sums.friction_of_bodies + sums.conducted;
    sums.heat_of_tool = partner.capacity > 0.
                            ? partner.capacity * (tool_temperature - partner.initial_temperature)
                            : sums.friction - sums.heat_of_bodies;
    sums.tool_temperature = tool_temperature;
  }

  template class ContactHeat<2>;
  template class ContactHeat<3>;
} // namespace tombolo
