// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/eroding_cells.h>

namespace tombolo
{
  namespace
  {
    const char *const erosion_strain_entry = "Erosion strain";
    const char *const erosion_damage_entry = "Erosion damage";
  } // namespace

  ErosionCriterion::ErosionCriterion(const Entries &e) : section(e.section())
  {
    largest_means.add(
        erosion_strain_entry,
        e.optional_number(erosion_strain_entry, positive(), "1",
                          "Effective plastic strain, as the mean of the points of a cell, at which "
                          "the cell is removed for the rest of the run; so is then a cell whose "
                          "volume is no longer positive. Empty: cells are not removed by strain."),
        MeanLimits::Of::strain);
    largest_means.add(
        erosion_damage_entry,
        e.optional_number(erosion_damage_entry, positive(), "1",
                          "Damage, as the mean of the points of a cell, at which the cell is "
                          "removed as with `Erosion strain`; 1 where it has failed. The material "
                          "needs a `Damage`. Empty: cells are not removed by damage."),
        MeanLimits::Of::damage);
  }

  void ErosionCriterion::initialize(const MaterialPoints &points, const bool has_mechanics)
  {
    if (is_on() && !has_mechanics)
      section.fail(largest_means.first_entry(),
                   "the scene has no mechanics, since its materials have no "
                   "stresses; nothing is strained.");
    largest_means.initialize(section, points);
  }
} // namespace tombolo
