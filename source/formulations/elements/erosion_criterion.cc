// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/erosion_criterion.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const entry = "Erosion strain";
  } // namespace

  void ErosionCriterion::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        entry, "", Patterns::Anything(),
        "Effective plastic strain, as the mean of the points of a cell, at which the cell is "
        "removed for the rest of the run; so is then a cell whose volume is no longer positive. "
        "Empty: cells are not removed. Units: 1.");
  }

  ErosionCriterion::ErosionCriterion(const Section &of_element)
  {
    if (of_element.get(entry).empty())
      return;
    section = of_element;
    largest_strain = of_element.get_positive(entry);
  }

  void ErosionCriterion::initialize(const MaterialPoints &points, const bool has_mechanics)
  {
    if (!is_on())
      return;
    if (!has_mechanics)
      section->fail(entry, "the scene has no mechanics, since its materials have no stresses; "
                           "nothing is strained.");
    field = points.find_field("effective plastic strain");
    if (field == points.fields().size())
      section->fail(entry, "the material of the part has no plastic strain; allowed is one with "
                           "plastic flow, such as \"j2 plasticity\".");
  }
} // namespace tombolo
