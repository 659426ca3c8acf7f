// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_section.h>

#include <tombolo/contact/contact_candidates.h>
#include <tombolo/contact/contact_settings.h>
#include <tombolo/contact/tool_heat.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  std::unique_ptr<ContactSurface<dim>> create_surface(const Section &section)
  {
    const std::string name = section.get("Surface");
    return Registry<ContactSurface<dim>>::instance().create(name, section.subsection(name));
  }

  template <int dim>
  void declare_surface_contact(const Entries &e)
  {
    e.choice("Surface", mandatory, Registry<ContactSurface<dim>>::instance().selection(),
             "The surface that nodes touch: a rigid one, or the boundary of a part.");
    e.plugins<ContactSurface<dim>>();
    declare_contact_candidates(e);
    declare<ContactSettings>(e);
    ToolHeat<dim>::declare_parameters(e);
  }

  template <int dim>
  void validate_surface_contact(const Section &section, const bool has_heat)
  {
    const Parameters &parameters = section.all();
    parameters.attempt([&] { ContactSettings settings(section, has_heat); });
    parameters.attempt([&] { create_surface<dim>(section); });
    const bool is_of_part = section.get("Surface") == surface_of_part;
    if (is_of_part && section.get("Method") != "penalty")
      parameters.attempt(
          [&]
          {
            section.fail("Method", "the surface is that of a part, which nodes push back by "
                                   "springs; allowed is penalty.");
          });
    if (has_heat && is_of_part)
      parameters.attempt([&] { ToolHeat<dim>::read_conductance(section); });
    else if (has_heat)
      parameters.attempt([&] { ToolHeat<dim>::create(section); });
    parameters.attempt([&] { validate_contact_candidates<dim>(section); });
  }

  template std::unique_ptr<ContactSurface<2>> create_surface(const Section &);
  template std::unique_ptr<ContactSurface<3>> create_surface(const Section &);
  template void declare_surface_contact<2>(const Entries &);
  template void declare_surface_contact<3>(const Entries &);
  template void validate_surface_contact<2>(const Section &, bool);
  template void validate_surface_contact<3>(const Section &, bool);
} // namespace tombolo
