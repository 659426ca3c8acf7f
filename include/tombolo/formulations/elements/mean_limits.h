// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/state/material_points.h>

#include <algorithm>
#include <string>
#include <vector>

namespace tombolo
{
  /** Limits of mean effective plastic strain and mean damage of the points of cells. */
  class MeanLimits
  {
  public:
    enum class Of
    {
      strain,
      damage
    };

    /** Reads an entry; empty: no limit. */
    void add(const Entries &e, const Of measure, const std::string &entry,
             const std::string &documentation)
    {
      if (const auto limit = e.optional_number(entry, positive(), "1", documentation))
        limits.push_back({entry, *limit, measure, 0});
    }

    const std::string &first_entry() const
    {
      return limits.front().entry;
    }
    bool empty() const
    {
      return limits.empty();
    }

    /** Finds the fields. Throws the InputError of @p section where the material has none. */
    void initialize(const Section &section, const MaterialPoints &points)
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

    /** Whether the cell at a slot, with @p n_points points, reaches one. */
    bool are_reached(const MaterialPoints &points, const unsigned int slot,
                     const unsigned int n_points) const
    {
      return std::any_of(limits.begin(), limits.end(),
                         [&](const Limit &limit)
                         {
                           const double *const values = points.component(limit.field, 0);
                           double sum = 0;
                           for (unsigned int q = 0; q < n_points; ++q)
                             sum += values[point_in_lanes(slot, n_points, q)];
                           return sum / n_points >= limit.value;
                         });
    }

    /** Whether some cell of a batch could reach one; seldom true where none does, and fast. */
    bool may_be_reached(const MaterialPoints &points, const unsigned int batch,
                        const unsigned int n_points) const
    {
      return std::any_of(limits.begin(), limits.end(),
                         [&](const Limit &limit)
                         {
                           const double *const values =
                               points.component(limit.field, 0) +
                               std::size_t(point_in_lanes(batch * n_lanes, n_points, 0));
                           Lanes sum = 0.;
                           for (unsigned int q = 0; q < n_points; ++q)
                             sum += load_lanes(values + q * n_lanes);
                           constexpr double less_round_off = 0.999;
                           return any_of(sum >= less_round_off * limit.value * n_points);
                         });
    }

  private:
    struct Limit
    {
      std::string entry;
      double value;
      Of measure;
      unsigned int field;
    };
    std::vector<Limit> limits;
  };
} // namespace tombolo
