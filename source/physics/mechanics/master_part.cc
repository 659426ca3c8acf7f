// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/master_part.h>

#include <tombolo/contact/contact_settings.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/physics/mechanics/named_parts.h>
#include <tombolo/physics/mechanics/rigid_body_settings.h>

#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void validate_master_part(const Section &contact, const std::vector<Part<dim>> &parts)
  {
    if (contact.get("Surface") != surface_of_part || parts.empty())
      return;
    const Section section = contact.subsection(surface_of_part);
    const std::string name = section.get("Part");
    const Part<dim> &part = parts[part_of_entry(section, "Part", name, parts)];
    if (!has_motion(part))
      section.fail("Part", "the part \"" + name +
                               "\" has no stresses and is not rigid, so that nothing moves it; "
                               "allowed is a part of elements with a material that has stresses, "
                               "or one with `Formulation = rigid`.");
    if (part.particles != nullptr)
      section.fail("Part", "the part \"" + name +
                               "\" consists of particles, which have no surface that stays; "
                               "allowed is a part of elements, or one with `Formulation = rigid`.");
  }

  template <int dim>
  MasterPart<dim> master_part(const Section &contact, const Model<dim> &model)
  {
    if (contact.get("Surface") != surface_of_part)
      return {};
    validate_master_part(contact, model.parts);
    const Section section = contact.subsection(surface_of_part);
    const std::string name = section.get("Part");
    const unsigned int number = part_of_entry(section, "Part", name, model.parts);
    const Part<dim> &part = model.parts[number];
    if (model.degree > 1)
      section.fail("Part", "elements have degree " + std::to_string(model.degree) +
                               "; the surface of a part needs degree 1.");
    if (part.formulation->can_lose_cells())
      section.fail("Part", "cells of the part \"" + name +
                               "\" can be removed, and what is below them has no faces; allowed "
                               "are other parts.");
    MasterPart<dim> result;
    result.layer =
        std::make_unique<PartLayer<dim>>(*model.nodes, [&](const typename Nodes<dim>::Cell &cell)
                                         { return model.part_cells->part_of(cell) == number; });
    if (rigid_cells(part) != nullptr)
      result.is_driven = !RigidBodySettings<dim>(section.all().section("Part: " + name + "/rigid"))
                              .moves_by_forces();
    return result;
  }

  template void validate_master_part(const Section &, const std::vector<Part<2>> &);
  template void validate_master_part(const Section &, const std::vector<Part<3>> &);
  template MasterPart<2> master_part(const Section &, const Model<2> &);
  template MasterPart<3> master_part(const Section &, const Model<3> &);
} // namespace tombolo
