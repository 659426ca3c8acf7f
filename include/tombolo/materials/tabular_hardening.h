// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>

#include <vector>

namespace tombolo
{
  /** A flow stress interpolated linearly in a table over the effective plastic strain and, where
   * the table has more than one row, the temperature; constant beyond its ends. */
  class TabularHardening : public FlowStress
  {
  public:
    explicit TabularHardening(const Entries &e);
    bool depends_on_temperature() const override;
    void evaluate(const FlowStressBatch &batch) const override;

  private:
    template <bool with_temperature>
    void interpolate(const FlowStressBatch &batch) const;

    // Knots of an axis with one value are doubled, so that every axis has an interval.
    std::vector<double> strains, temperatures;
    std::vector<double> values; // [M/(L T^2)], strain fastest
  };
} // namespace tombolo
