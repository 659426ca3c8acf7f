// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/eroding_cells.h>

namespace tombolo
{
  ErosionCriterion::ErosionCriterion(const Entries &e) : section(e.section())
  {
    add(e, Of::strain, "Erosion strain",
        "Effective plastic strain, as the mean of the points of a cell, at which "
        "the cell is removed for the rest of the run; so is then a cell whose "
        "volume is no longer positive. Empty: cells are not removed by strain.");
    add(e, Of::damage, "Erosion damage",
        "Damage, as the mean of the points of a cell, at which the cell is "
        "removed as with `Erosion strain`; 1 where it has failed. The material "
        "needs a `Damage`. Empty: cells are not removed by damage.");
  }

  void ErosionCriterion::initialize(const MaterialPoints &points, const bool has_mechanics)
  {
    if (!empty() && !has_mechanics)
      section.fail(first_entry(), "the scene has no mechanics, since its materials have no "
                                  "stresses; nothing is strained.");
    MeanLimits::initialize(section, points);
  }
} // namespace tombolo
