// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/mean_limits.h>

#include <tombolo/formulations/elements/cell_batches.h>

#include <algorithm>

namespace tombolo
{
  void MeanLimits::add(const std::string &entry, const std::optional<double> &limit,
                       const Of measure)
  {
    if (limit)
      limits.push_back({entry, *limit, measure, 0});
  }

  void MeanLimits::initialize(const Section &section, const MaterialPoints &points)
  {
    for (Limit &limit : limits)
    {
      const bool is_strain = limit.measure == Of::strain;
      limit.field = points.find_field(is_strain ? "effective plastic strain" : "damage");
      if (limit.field == points.fields().size())
        section.fail(limit.entry,
                     is_strain
                         ? "the material of the part has no plastic strain; allowed is one "
                           "with plastic flow, such as \"j2 plasticity\"."
                         : "the material of the part has no damage; allowed is one that has, "
                           "such as \"j2 plasticity\" with \"Damage = johnson cook damage\".");
    }
  }

  bool MeanLimits::are_reached(const MaterialPoints &points, const unsigned int place,
                               const unsigned int n_points) const
  {
    return std::any_of(limits.begin(), limits.end(),
                       [&](const Limit &limit)
                       {
                         const double *const values = points.component(limit.field, 0);
                         double sum = 0;
                         for (unsigned int q = 0; q < n_points; ++q)
                           sum += values[point_in_lanes(place, n_points, q)];
                         return sum / n_points >= limit.value;
                       });
  }
} // namespace tombolo
