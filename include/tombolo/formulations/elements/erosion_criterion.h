// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/state/material_points.h>

#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** When a cell of elements is removed: where the mean effective plastic strain of its points, or
   * their mean damage, reaches a limit. Off unless a limit is given. */
  class ErosionCriterion
  {
  public:
    /** A field of points, and the mean over a cell at which the cell is removed. */
    struct Limit
    {
      std::string entry;
      double value = 0;
      unsigned int field = 0;
    };

    /** None. */
    ErosionCriterion() = default;
    explicit ErosionCriterion(const Entries &e);
    bool is_on() const
    {
      return section.has_value();
    }

    /** A cell that reaches one of them is removed; none if off. */
    const std::vector<Limit> &limits() const
    {
      return all_limits;
    }

    /** Finds the fields in @p points, which are none where the scene has no mechanics. Throws
     * InputError where the material has no such field. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

  private:
    std::optional<Section> section;
    std::vector<Limit> all_limits;
  };
} // namespace tombolo
