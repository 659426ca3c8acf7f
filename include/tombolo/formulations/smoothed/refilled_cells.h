// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/void_cells.h>

#include <vector>

namespace tombolo
{
  /** What a part of smoothed cells needs to know of its refills: when they are due, of which mesh
   * it is made, and which of the cells are void. Must stay where it is. */
  template <int dim>
  class RefilledCells
  {
  public:
    /** Throws InputError. */
    explicit RefilledCells(const Section &section) : refill_settings(section) {}

    const RefillSettings &settings() const
    {
      return refill_settings;
    }

    const VoidCells<dim> &void_cells() const
    {
      return voids;
    }
    void set_void_cells(const std::vector<bool> &is_void)
    {
      voids.set(is_void);
    }

    /** Refuses parts that cannot be refilled, or whose cells cannot become particles by @p
     * conversion. Returns @p of_part with void cells, which those are that have become particles.
     * Throws InputError. Collective. */
    const PartSetup<dim> &initialize(const PartSetup<dim> &of_part,
                                     const ConversionCriterion &conversion);

    const PartSetup<dim> &setup() const
    {
      return part_setup;
    }

    /** Takes the masses of void cells away. */
    void take_masses(CellBatches<dim> &cells) const;

    /** Whether one of the points that have these rows has reached a limit. */
    bool is_distorted(const Stencils &rows, const std::vector<unsigned int> &points,
                      const NodalVector &position) const;

  private:
    /** Lets cells become void that become particles. Throws InputError. Collective. */
    void prepare_conversion(const PartSetup<dim> &of_part, const ConversionCriterion &conversion);

    RefillSettings refill_settings;
    PartSetup<dim> part_setup;
    VoidCells<dim> voids;
  };
} // namespace tombolo
