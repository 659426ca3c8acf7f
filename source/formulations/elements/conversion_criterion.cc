// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/conversion_criterion.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const strain_entry = "Conversion strain";
    const char *const damage_limit_entry = "Conversion damage";
    const char *const jacobian_entry = "Conversion scaled Jacobian";
    const char *const time_step_entry = "Conversion time step";
    const char *const gap_entry = "Conversion gap";
    const char *const contact_entry = "Conversion contact";
    const char *const layers_entry = "Conversion layers";
    const char *const interval_entry = "Steps between conversions";
  } // namespace

  void ConversionCriterion::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        strain_entry, "", Patterns::Anything(),
        "Effective plastic strain, as the mean of the points of a cell, at which the cell becomes "
        "particles, those of the part with `Cells = from` this part. Empty: not by strain. Units: "
        "1.");
    handler.declare_entry(
        damage_limit_entry, "", Patterns::Anything(),
        "Damage, as the mean of the points of a cell, at which the cell becomes particles; 1 where "
        "it has failed. The material needs a `Damage`. Empty: not by damage. Units: 1.");
    handler.declare_entry(
        jacobian_entry, "", Patterns::Anything(),
        "A cell becomes particles where the smallest determinant of the unit vectors along the "
        "edges at its corners falls below this: one for a brick, zero for a flat corner. Empty: "
        "not by shape. Units: 1.");
    handler.declare_entry(
        time_step_entry, "", Patterns::Anything(),
        "A cell becomes particles where the time that a longitudinal wave takes through it falls "
        "below this (eq. 41 without its factor). Empty: not by the step. Units: T.");
    handler.declare_entry(
        gap_entry, "", Patterns::Anything(),
        "A cell becomes particles where one of its nodes is nearer than this to the surface of the "
        "`Conversion contact`: neither the tool nor strong gradients meet elements. Empty: not by "
        "nearness. Units: L.");
    Parameters::declare_mandatory(
        handler, contact_entry, Patterns::Anything(),
        "The name of the contact, one of `Contacts`, for `Conversion gap`.");
    handler.declare_entry(layers_entry, "1", Patterns::Integer(0, 100),
                          "With a cell that becomes particles go so many layers of cells of the "
                          "part around it.");
    handler.declare_entry(interval_entry, "20", Patterns::Integer(1, 1000000),
                          "Cells are compared with the limits of conversion every so many steps.");
  }

  ConversionCriterion::ConversionCriterion(const Section &of_element)
  {
    const auto read = [&](const char *const entry, std::optional<double> &limit)
    {
      if (of_element.get(entry).empty())
        return;
      limit = of_element.get_positive(entry);
      section = of_element;
    };
    read(strain_entry, largest_strain);
    read(damage_limit_entry, largest_damage);
    read(jacobian_entry, smallest_jacobian);
    read(time_step_entry, smallest_time_step);
    read(gap_entry, smallest_gap);
    if (smallest_gap)
      contact_name = of_element.get(contact_entry);
    if (!is_on())
      return;
    if (smallest_jacobian && *smallest_jacobian >= 1.)
      of_element.fail(jacobian_entry, "allowed is a number between 0 and 1; no cell has more than "
                                      "1, so that all would become particles at once");
    layers = of_element.get_unsigned(layers_entry);
    steps_between_looks = of_element.get_unsigned(interval_entry);
  }

  void ConversionCriterion::refuse(const std::string &message) const
  {
    section->fail(largest_strain       ? strain_entry
                  : largest_damage     ? damage_limit_entry
                  : smallest_jacobian  ? jacobian_entry
                  : smallest_time_step ? time_step_entry
                                       : contact_entry,
                  message);
  }

  void ConversionCriterion::initialize(const MaterialPoints &points, const bool has_mechanics)
  {
    if (!is_on())
      return;
    if (!has_mechanics)
      refuse("the scene has no mechanics, since its materials have no stresses; nothing is "
             "deformed.");
    if (largest_damage)
    {
      damage_field = points.find_field("damage");
      if (damage_field == points.fields().size())
        section->fail(damage_limit_entry,
                      "the material of the part has no damage; allowed is one that has, such as "
                      "\"j2 plasticity\" with \"Damage = johnson cook damage\".");
    }
    if (!largest_strain)
      return;
    field = points.find_field("effective plastic strain");
    if (field == points.fields().size())
      section->fail(strain_entry, "the material of the part has no plastic strain; allowed is one "
                                  "with plastic flow, such as \"j2 plasticity\".");
  }
} // namespace tombolo
