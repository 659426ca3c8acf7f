// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_settings.h>

#include <tombolo/base/input/text.h>

namespace tombolo
{
  void FrictionSettings::read_friction(const Entries &e, const std::string &documentation)
  {
    friction = e.object<TemperatureTable>("Friction", "0", "", documentation);
    e.refuse(!(friction.smallest() >= 0. && friction.largest() <= 10.), "Friction",
             friction.is_constant() ? "allowed is a number from 0 to 10."
                                    : "allowed are coefficients from 0 to 10.");
    e.refuse(!friction.is_constant() && !has_heat, "Friction",
             "the scene has no temperature; allowed is one number, or materials with a section "
             "\"Heat\".");
  }

  void FrictionSettings::read_heat_fraction(const Entries &e, const std::string &documentation)
  {
    const std::string text = e.text("Heat fraction", "0.5", "", documentation);
    splits_by_effusivity = text == "by effusivity";
    if (e.declares() || splits_by_effusivity)
      return;
    if (!is_number(text, heat_fraction))
      e.section().fail("Heat fraction", "allowed is a number from 0 to 1, or \"by effusivity\".");
    e.refuse(!(heat_fraction >= 0. && heat_fraction <= 1.), "Heat fraction",
             "allowed is a number from 0 to 1.");
  }

  ContactSettings::ContactSettings(const Entries &e, const bool has_heat)
      : FrictionSettings(has_heat)
  {
    const std::string method = e.choice(
        "Method", "penalty", "penalty|kinematic|surface",
        "How nodes are kept out of the surface: by springs and dampers, or `kinematic`, by the "
        "forces that put nodes which would be behind the surface at the end of the step onto it: "
        "no penetration, no limit of the step, and an impact takes the energy of the nodes that "
        "arrive. `surface`: springs and dampers between the faces of the body and the surface, by "
        "points on faces, so that a face does not fall between two flanks of a tool. `Stiffness` "
        "and `Damping` are those of springs and dampers alone.");
    is_kinematic = method == "kinematic";
    is_of_faces = method == "surface";
    if (e.when(!is_kinematic))
    {
      const double stiffness = e.number(
          "Stiffness", "0.37",
          positive_up_to(1., ": a stiffer spring is not stable at the time step of the bodies."),
          "",
          "Penalty stiffness of a node as a fraction of its mass over the square of the stable "
          "time step, above 0 and up to 1.");
      const double damping =
          e.number("Damping", "0.5", from_to(0., 1.), "",
                   "Fraction of critical damping while a node approaches, from 0 to 1.");
      const bool damps_return =
          e.flag("Damp return", "false",
                 "The damper also acts while a node leaves, and takes what the spring has stored, "
                 "but never pulls: for an impact, with `Damping = 1`.");
      law = ContactLaw(stiffness, damping, damps_return);
    }
    read_friction(
        e, "Coulomb's coefficient of friction, from 0 to 10; 0 is frictionless contact. In scenes "
           "with heat also pairs `temperature: value` separated by commas, over the temperature of "
           "the body, joined by straight lines.");
    const std::string limit =
        e.text("Shear limit", "", "M/(L T^2)",
               "The largest traction along the surface, which friction does not exceed however "
               "large the pressure: a number, or `yield`, 1/√3 of the present yield stress of the "
               "body at the node. Empty: there is no limit.");
    radius = e.number("Radius", "0", at_least(0.), "L",
                      "A node is a ball of this radius: contact begins where it is so near to the "
                      "surface. Half of the spacing, for particles that stand for the volume "
                      "around them. Not with `Method = surface`.");
    e.refuse(
        is_of_faces && radius > 0., "Radius",
        "with `Method = surface` faces touch, which have none; allowed is 0, or another `Method`.");
    shears_at_yield = limit == "yield";
    if (!limit.empty() && !shears_at_yield)
      shear_limit = e.section().get_positive("Shear limit");
    cutting_speed = e.number(
        "Cutting speed", "0", at_least(0.), "L/T",
        "Of a tool that cuts: particles faster than twice this speed are counted as `particles "
        "that fly off` in statistics.csv and in the summary. 0: they are not counted.");
    // Read with the positions of nodes.
    if (e.declares())
      e.text(
          "Corridor", "", "",
          "Where nodes are at the start that the surface is meant to touch, such as the particles "
          "or the refined cells along the way of a tool: a condition on x, y, z. The log says when "
          "and where another one is touched first. Empty: all may be.");
    if (!e.when(has_heat))
      return;
    read_heat_fraction(
        e, "Share of the heat of friction that enters the body, from 0 to 1; the rest is the "
           "surface's. `by effusivity`: e/(e + `Tool effusivity`) at the present temperatures, "
           "with the e = √(k ρ c) of the body at the node. Only in scenes with heat.");
    if (e.when(splits_by_effusivity && e.section().get("Surface") != surface_of_part))
    {
      tool_effusivity = e.object<TemperatureTable>(
          "Tool effusivity", mandatory, "M/(T^(5/2) temperature)",
          "√(k ρ c) of the tool, for `Heat fraction = by effusivity`; that of a part follows from "
          "its material. One number, or pairs `temperature: value` separated by commas, over the "
          "`Tool temperature`, or that of the body where the tool has none.");
      e.refuse(!(tool_effusivity.smallest() > 0.), "Tool effusivity",
               "allowed are numbers above 0.");
    }
  }
} // namespace tombolo
