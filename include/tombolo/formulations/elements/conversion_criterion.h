// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/mean_limits.h>

#include <optional>
#include <string>

namespace tombolo
{
  /** When a cell of elements becomes particles: where the mean effective plastic strain of its
   * points, their mean damage, its shape or the time that a wave needs through it reaches a limit,
   * or where it comes near to a surface. Off unless one of the limits is given. */
  struct ConversionCriterion
  {
    /** None. */
    ConversionCriterion() = default;
    explicit ConversionCriterion(const Entries &e);

    bool is_on() const
    {
      return section.has_value();
    }

    /** Finds strain and damage in @p points, which are none where the scene has no mechanics.
     * Throws InputError where the material has no such field. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

    /** Throws InputError for the entry that switches the criterion on. Only if on. */
    [[noreturn]] void refuse(const std::string &message) const;

    MeanLimits largest_means; ///< of strain and damage

    /** Limits; empty: none. Cells with a node nearer than the gap to the contact convert [L]. */
    std::optional<double> smallest_jacobian, smallest_time_step, smallest_gap;
    std::string contact;       ///< the name of the contact; with a gap only
    unsigned int layers = 0;   ///< of cells around one that fulfils the criterion that go with it
    unsigned int interval = 1; ///< cells are checked every so many steps

  private:
    std::optional<Section> section;
  };
} // namespace tombolo
