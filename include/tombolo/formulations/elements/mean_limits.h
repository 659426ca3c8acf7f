// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/state/material_points.h>

#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  /** Limits of the effective plastic strain and of the damage of cells, as the means of their
   * points. */
  class MeanLimits
  {
  public:
    enum class Of
    {
      strain,
      damage
    };

    /** One that this entry gives; nothing: none. */
    void add(const std::string &entry, const std::optional<double> &limit, Of measure);

    const std::string &first_entry() const
    {
      return limits.front().entry;
    }
    bool empty() const
    {
      return limits.empty();
    }

    /** Finds the fields in @p points. Throws the InputError of @p section where the material has
     * none. */
    void initialize(const Section &section, const MaterialPoints &points);

    /** Whether the cell at a place, with @p n_points points, reaches one. */
    bool are_reached(const MaterialPoints &points, unsigned int place, unsigned int n_points) const;

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
