// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/tool_heat.h>

#include <tombolo/base/ordered_sum.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void ToolHeat<dim>::declare_parameters(const Entries &e)
  {
    e.text("Conductance", "0", "M/(T^3 temperature)",
           "h of the heat h (tool temperature - temperature) that enters the body per area in "
           "contact and time: one number, or pairs `pressure: value` separated by commas, joined "
           "by straight lines. 0: nothing is conducted. Only in scenes with heat.");
    e.number("Tool temperature", mandatory, any_number(), "temperature",
             "The temperature of the tool, at the start where it has a `Heat capacity`. Needed for "
             "a tool that conducts or has one.");
    e.number("Heat capacity", "0", any_number(), "M L^2/(T^2 temperature)",
             "Of the whole tool, whose temperature then changes by its share of the heat of "
             "friction and by what it conducts; 0 for a tool that keeps its temperature. Only in "
             "scenes with heat.");
  }

  template <int dim>
  TemperatureTable ToolHeat<dim>::read_conductance(const Section &section)
  {
    TemperatureTable conductance(section, "Conductance", "pressure");
    if (conductance.smallest() < 0.)
      section.fail("Conductance", "allowed are numbers from zero on.");
    return conductance;
  }

  template <int dim>
  std::unique_ptr<ToolHeat<dim>> ToolHeat<dim>::create(const Section &section)
  {
    TemperatureTable conductance = read_conductance(section);
    const double capacity = section.get_double("Heat capacity");
    if (!(capacity >= 0.))
      section.fail("Heat capacity", "allowed is zero or a positive number.");
    if (conductance.largest() == 0. && capacity == 0.)
      return nullptr;
    return std::unique_ptr<ToolHeat>(new ToolHeat(section, std::move(conductance)));
  }

  template <int dim>
  ToolHeat<dim>::ToolHeat(const Section &section, TemperatureTable conductance)
      : HeatPartner(std::move(conductance)),
        initial_temperature(section.get_double("Tool temperature")),
        capacity(section.get_double("Heat capacity")), tool_temperature(initial_temperature)
  {}

  template <int dim>
  bool ToolHeat<dim>::has_capacity() const
  {
    return capacity > 0.;
  }

  template <int dim>
  double ToolHeat<dim>::temperature() const
  {
    return tool_temperature;
  }

  template <int dim>
  void ToolHeat<dim>::end_step(const double friction, const NodalHeat &nodal_heat,
                               const MPI_Comm communicator)
  {
    const NodalEnthalpy &nodal_enthalpy = *nodal_heat.enthalpy;
    offers.clear();
    for (const Touch &touch : touches)
    {
      const unsigned int node = touch.node;
      const double of_node = nodal_heat.enthalpy_of(node);
      const double temperature = nodal_enthalpy.temperature(node, of_node);
      const double node_capacity =
          mean_capacity(nodal_enthalpy, node, of_node, temperature, tool_temperature);
      offers.push_back({response(touch, nodal_heat, node_capacity), temperature});
    }
    if (has_capacity())
    {
      // Differences to the temperature before, so that a tool that nothing heats keeps it exactly.
      std::array<double, 2> sums{{friction, 0.}};
      for (const Offer &offer : offers)
      {
        sums[0] -= offer.response * (tool_temperature - offer.temperature);
        sums[1] += offer.response;
      }
      sums = ordered_sum(sums, communicator);
      tool_temperature += sums[0] / (capacity + sums[1]);
    }
    for (std::size_t i = 0; i < offers.size(); ++i)
    {
      const double received = offers[i].response * (tool_temperature - offers[i].temperature);
      nodal_heat.conduction->add(touches[i].node, received);
      conducted_heat += received;
    }
  }

  template <int dim>
  double ToolHeat<dim>::stored() const
  {
    return capacity * (tool_temperature - initial_temperature);
  }

  template class ToolHeat<2>;
  template class ToolHeat<3>;
} // namespace tombolo
