// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refill_settings.h>

#include <vector>

namespace tombolo
{
  /**
   * Which cells of a part are void: cells of the mesh without material, which a refill can fill, as
   * it can empty others. Known of owned and of ghost cells. Off, all cells are full.
   */
  template <int dim>
  class VoidCells
  {
  public:
    using Cell = typename Nodes<dim>::Cell;

    /** Void are the cells of the part with their centre where @p is_void is true. Throws InputError
     * where that cannot be evaluated. Collective. */
    void initialize(const PartSetup<dim> &setup, const Predicate<dim> &is_void);

    /** None is void yet. Collective. */
    void initialize(const PartSetup<dim> &setup);

    bool is_on() const
    {
      return nodes != nullptr;
    }

    /** Of an owned or ghost cell of the part. */
    bool is_void(const Cell &cell) const
    {
      return is_on() && flags[cell->active_cell_index()];
    }

    /** Of the owned cells of the part, in the order of active cells. */
    const std::vector<bool> &of_cells() const
    {
      return of_owned;
    }

    /** Other ones, in this order. Collective. */
    void set(const std::vector<bool> &is_void);

  private:
    const Nodes<dim> *nodes = nullptr;
    const PartCells<dim> *part_cells = nullptr;
    unsigned int part = 0;
    std::vector<bool> of_owned;
    std::vector<bool> flags; // by the index of active cells
  };

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
