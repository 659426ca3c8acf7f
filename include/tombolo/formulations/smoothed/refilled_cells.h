// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

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

  /** @p of_part with void cells: those that its refills begin with, and those that become particles
   * by @p conversion. They are kept in @p voids. Throws InputError where a part cannot be refilled,
   * or its cells cannot become particles. Collective. */
  template <int dim>
  PartSetup<dim> with_void_cells(const PartSetup<dim> &of_part, const RefillSettings<dim> &refill,
                                 const ConversionCriterion &conversion, VoidCells<dim> &voids);
} // namespace tombolo
