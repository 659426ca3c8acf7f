// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_heat.h>

namespace tombolo
{
  using namespace dealii;

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
