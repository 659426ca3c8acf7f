// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/state/material_points.h>

#include <optional>

namespace tombolo
{
  /** When a cell of elements is removed: where the mean effective plastic strain of its points
   * reaches a limit. Off unless the limit is given. */
  class ErosionCriterion
  {
  public:
    /** None. */
    ErosionCriterion() = default;
    explicit ErosionCriterion(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);

    bool is_on() const
    {
      return section.has_value();
    }

    /** The limit; only if on. */
    double strain() const
    {
      return largest_strain;
    }

    /** Finds the strain in @p points, which are none where the scene has no mechanics. Throws
     * InputError where the material has no such strain. Does nothing if off. */
    void initialize(const MaterialPoints &points, bool has_mechanics);

    /** The effective plastic strain of all points; only if on. */
    const double *plastic_strain(const MaterialPoints &points) const
    {
      return points.component(field, 0);
    }

  private:
    std::optional<Section> section;
    double largest_strain = 0;
    unsigned int field = 0;
  };
} // namespace tombolo
