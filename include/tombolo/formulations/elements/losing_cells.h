// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/elements/lost_cells.h>

namespace tombolo
{
  /** What all parts have whose cells can become particles: when they do, and which are lost. */
  template <int dim>
  class LosingCells : public ConvertingCells<dim>
  {
  public:
    LosingCells() = default;
    explicit LosingCells(const Section &section) : criterion(section) {}

    const ConversionCriterion &conversion() const override
    {
      return criterion;
    }

    void keep_dissipated(const EnergyAccounts &lost) override
    {
      lost_cells.keep_dissipated(lost);
    }

    unsigned int n_converted_cells() const override
    {
      return lost_cells.n_converted();
    }

  protected:
    ConversionCriterion criterion; ///< of conversion
    LostCells lost_cells;
  };
} // namespace tombolo
