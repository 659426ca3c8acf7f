// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_settings.h>

#include <tombolo/contact/heat_fraction.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    ContactLaw read_law(const Section &section)
    {
      const double stiffness = section.get_positive("Stiffness");
      if (stiffness > 1.)
        section.fail("Stiffness",
                     "allowed is a number above 0 and up to 1: a stiffer spring is not "
                     "stable at the time step of the bodies.");
      const double damping = section.get_double("Damping");
      if (!(damping >= 0. && damping <= 1.))
        section.fail("Damping", "allowed is a number from 0 to 1.");
      return ContactLaw(stiffness, damping);
    }
  } // namespace

  void ContactSettings::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Method", "penalty", Patterns::Selection("penalty|kinematic|surface"),
        "How nodes are kept out of the surface: by springs and dampers, or `kinematic`, by the "
        "forces that put nodes which would be behind the surface at the end of the step onto it: "
        "no penetration, no limit of the step, and an impact takes the energy of the nodes that "
        "arrive. `surface`: springs and dampers between the faces of the body and the surface, "
        "by points on faces, so that a face does not fall between two flanks of a tool. "
        "`Stiffness` and `Damping` are those of springs and dampers alone.");
    handler.declare_entry(
        "Stiffness", "0.37", Patterns::Double(),
        "Penalty stiffness of a node as a fraction of its mass over the square of "
        "the stable time step, above 0 and up to 1.");
    handler.declare_entry("Damping", "0.5", Patterns::Double(),
                          "Fraction of critical damping while a node approaches, from 0 to 1.");
    handler.declare_entry("Friction", "0", Patterns::Anything(),
                          "Coulomb's coefficient of friction, from 0 to 10; 0 is frictionless "
                          "contact. In scenes with heat also pairs `temperature: value` separated "
                          "by commas, over the temperature of the body, joined by straight lines.");
    handler.declare_entry(
        "Shear limit", "", Patterns::Anything(),
        "The largest traction along the surface, which friction does not exceed however large the "
        "pressure: a number, or `yield`, 1/√3 of the present yield stress of the body at the node. "
        "Empty: there is no limit. Units: M/(L T^2).");
    handler.declare_entry(
        "Radius", "0", Patterns::Double(0.),
        "A node is a ball of this radius: contact begins where it is so near to the surface. Half "
        "of the spacing, for particles that stand for the volume around them. Not with `Method = "
        "surface`. Units: L.");
    handler.declare_entry(
        "Cutting speed", "0", Patterns::Double(0.),
        "Of a tool that cuts: particles faster than twice this speed are counted as "
        "`particles that fly off` in statistics.csv and in the summary. 0: they are not counted. "
        "Units: L/T.");
    handler.declare_entry(
        "Corridor", "", Patterns::Anything(),
        "Where nodes are at the start that the surface is meant to touch, such as the particles or "
        "the refined cells along the way of a tool: a condition on x, y, z. The log says when and "
        "where another one is touched first. Empty: all may be.");
    handler.declare_entry(
        "Heat fraction", "0.5", Patterns::Anything(),
        "Share of the heat of friction that enters the body, from 0 to 1; the rest is "
        "the surface's. `by effusivity`: e/(e + `Tool effusivity`) at the present temperatures, "
        "with the e = √(k ρ c) of the body at the node. Only in scenes with heat.");
    Parameters::declare_mandatory(
        handler, "Tool effusivity", Patterns::Anything(),
        "√(k ρ c) of the tool, for `Heat fraction = by effusivity`; that of a part follows from "
        "its "
        "material. One number, or pairs "
        "`temperature: value` separated by commas, over the `Tool temperature`, or that of the "
        "body where the tool has none. Units: M/(T^(5/2) temperature).");
  }

  ContactSettings::ContactSettings(const Section &section, const bool has_heat) : has_heat(has_heat)
  {
    is_kinematic = section.get("Method") == "kinematic";
    is_of_faces = section.get("Method") == "surface";
    if (!is_kinematic)
      law = read_law(section);
    friction = TemperatureTable(section, "Friction");
    if (!(friction.smallest() >= 0. && friction.largest() <= 10.))
      section.fail("Friction", friction.is_constant() ? "allowed is a number from 0 to 10."
                                                      : "allowed are coefficients from 0 to 10.");
    if (!friction.is_constant() && !has_heat)
      section.fail("Friction", "the scene has no temperature; allowed is one number, or materials "
                               "with a section \"Heat\".");
    radius = section.get_double("Radius");
    cutting_speed = section.get_double("Cutting speed");
    if (is_of_faces && radius > 0.)
      section.fail("Radius", "with `Method = surface` faces touch, which have none; allowed is 0, "
                             "or another `Method`.");
    shears_at_yield = section.get("Shear limit") == "yield";
    if (!section.get("Shear limit").empty() && !shears_at_yield)
      shear_limit = section.get_positive("Shear limit");
    if (!has_heat)
      return;
    splits_by_effusivity = section.get("Heat fraction") == by_effusivity;
    if (splits_by_effusivity && section.get("Surface") == surface_of_part)
      return;
    if (splits_by_effusivity)
    {
      tool_effusivity = TemperatureTable(section, "Tool effusivity");
      if (!(tool_effusivity.smallest() > 0.))
        section.fail("Tool effusivity", "allowed are numbers above 0.");
      return;
    }
    heat_fraction = read_heat_fraction(section);
  }
} // namespace tombolo
