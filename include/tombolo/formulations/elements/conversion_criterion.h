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
  class ConversionCriterion
  {
  public:
    /** None. */
    ConversionCriterion() = default;
    explicit ConversionCriterion(const Entries &e);
    bool is_on() const
    {
      return section.has_value();
    }

    /** Of strain and damage. */
    const MeanLimits &means() const
    {
      return largest_means;
    }

    /** Limits; empty: none. */
    const std::optional<double> &scaled_jacobian() const
    {
      return smallest_jacobian;
    }
    const std::optional<double> &time_step() const
    {
      return smallest_time_step;
    }

    /** Cells with a node nearer than this to the surface of the contact become particles [L]. */
    const std::optional<double> &gap() const
    {
      return smallest_gap;
    }
    /** The name of the contact; with a gap only. */
    const std::string &contact() const
    {
      return contact_name;
    }

    /** How many layers of cells around one that fulfils the criterion go with it. */
    unsigned int n_layers() const
    {
      return layers;
    }

    /** Cells are checked every so many steps. */
    unsigned int interval() const
    {
      return steps_between_looks;
    }

    /** Finds strain and damage in @p points, which are none where the scene has no mechanics.
     * Throws InputError where the material has no such field. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

    /** Throws InputError for the entry that switches the criterion on. Only if on. */
    [[noreturn]] void refuse(const std::string &message) const;

  private:
    std::optional<Section> section;
    MeanLimits largest_means;
    std::optional<double> smallest_jacobian, smallest_time_step, smallest_gap;
    std::string contact_name;
    unsigned int layers = 0, steps_between_looks = 1;
  };
} // namespace tombolo
