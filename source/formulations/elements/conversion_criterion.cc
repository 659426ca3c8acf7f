// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/converting_cells.h>

namespace tombolo
{
  namespace
  {
    const char *const jacobian_entry = "Conversion scaled Jacobian";
    const char *const time_step_entry = "Conversion time step";
    const char *const contact_entry = "Conversion contact";
  } // namespace

  ConversionCriterion::ConversionCriterion(const Entries &e)
  {
    largest_means.add(
        e, MeanLimits::Of::strain, "Conversion strain",
        "Effective plastic strain, as the mean of the points of a cell, at which the cell becomes "
        "particles, those of the part with `Cells = from` this part. Empty: not by strain.");
    largest_means.add(
        e, MeanLimits::Of::damage, "Conversion damage",
        "Damage, as the mean of the points of a cell, at which the cell becomes particles; 1 where "
        "it has failed. The material needs a `Damage`, or a variable `damage` of its own. Empty: "
        "not by damage.");
    smallest_jacobian =
        e.optional_number(jacobian_entry, positive(), "1",
                          "A cell becomes particles where the smallest determinant of the unit "
                          "vectors along the edges at its corners falls below this: one for a "
                          "brick, zero for a flat corner. Empty: not by shape.");
    e.refuse(smallest_jacobian && *smallest_jacobian >= 1., jacobian_entry,
             "allowed is a number between 0 and 1; no cell has more than 1, so that all would "
             "become particles at once");
    smallest_time_step = e.optional_number(
        time_step_entry, positive(), "T",
        "A cell becomes particles where the time that a longitudinal wave takes through it falls "
        "below this (eq. 41 without its factor). Empty: not by the step.");
    smallest_gap =
        e.optional_number("Conversion gap", positive(), "L",
                          "A cell becomes particles where one of its nodes is nearer than this to "
                          "the surface of the `Conversion contact`: neither the tool nor strong "
                          "gradients meet elements. Empty: not by nearness.");
    if (e.when(smallest_gap.has_value()))
      contact = e.text(contact_entry, mandatory, "",
                       "The name of the contact, one of `Contacts`, for `Conversion gap`.");
    if (!e.when(!largest_means.empty() || smallest_jacobian || smallest_time_step || smallest_gap))
      return;
    section = e.section();
    layers = e.integer(
        "Conversion layers", "1", between(0, 100),
        "With a cell that becomes particles go so many layers of cells of the part around it.");
    interval = e.integer("Steps between conversions", "20", between(1, 1000000),
                         "Cells are compared with the limits of conversion every so many steps.");
  }

  void ConversionCriterion::refuse(const std::string &message) const
  {
    section->fail(!largest_means.empty() ? largest_means.first_entry()
                  : smallest_jacobian    ? jacobian_entry
                  : smallest_time_step   ? time_step_entry
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
    largest_means.initialize(*section, points);
  }
} // namespace tombolo
