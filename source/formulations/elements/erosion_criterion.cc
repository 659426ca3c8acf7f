// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/erosion_criterion.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    const char *const erosion_strain_entry = "Erosion strain";
    const char *const erosion_damage_entry = "Erosion damage";
  } // namespace

  ErosionCriterion::ErosionCriterion(const Entries &e)
  {
    const auto add = [&](const char *const entry, const std::optional<double> &limit)
    {
      if (!limit)
        return;
      section = e.section();
      all_limits.push_back({entry, *limit, 0});
    };
    add(erosion_strain_entry,
        e.optional_number(erosion_strain_entry, positive(), "1",
                          "Effective plastic strain, as the mean of the points of a cell, at which "
                          "the cell is removed for the rest of the run; so is then a cell whose "
                          "volume is no longer positive. Empty: cells are not removed by strain."));
    add(erosion_damage_entry,
        e.optional_number(erosion_damage_entry, positive(), "1",
                          "Damage, as the mean of the points of a cell, at which the cell is "
                          "removed as with `Erosion strain`; 1 where it has failed. The material "
                          "needs a `Damage`. Empty: cells are not removed by damage."));
  }

  void ErosionCriterion::initialize(const MaterialPoints &points, const bool has_mechanics)
  {
    for (Limit &limit : all_limits)
    {
      if (!has_mechanics)
        section->fail(limit.entry, "the scene has no mechanics, since its materials have no "
                                   "stresses; nothing is strained.");
      const bool is_strain = limit.entry == erosion_strain_entry;
      limit.field = points.find_field(is_strain ? "effective plastic strain" : "damage");
      if (limit.field == points.fields().size())
        section->fail(limit.entry,
                      is_strain
                          ? "the material of the part has no plastic strain; allowed is one "
                            "with plastic flow, such as \"j2 plasticity\"."
                          : "the material of the part has no damage; allowed is one that has, "
                            "such as \"j2 plasticity\" with \"Damage = johnson cook "
                            "damage\".");
    }
  }
} // namespace tombolo
