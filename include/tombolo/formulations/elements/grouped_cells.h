// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>

#include <vector>

namespace tombolo
{
  /**
   * A part whose cells need not take every step: a cell of the step ratio r is evaluated at every
   * r-th one. Cells of one ratio are a group. All ratios are one until others are set.
   */
  template <int dim>
  class GroupedCells
  {
  public:
    using Group = typename CellBatches<dim>::Group; ///< its number is the ratio

    static constexpr unsigned int most_groups = 8;

    virtual ~GroupedCells() = default;

    /** Is called before Formulation::initialize() where cells are to be grouped. */
    virtual void prepare_groups() = 0;

    /** Sets these ratios of cells, in the order of Formulation::courant_limits(). */
    virtual void set_step_ratios(const std::vector<unsigned int> &cell_ratios) = 0;

    virtual const std::vector<Group> &groups() const = 0;

    /** The local nodes of a group, cell by cell. */
    virtual std::vector<unsigned int> nodes_of(const Group &group) const = 0;

    /** Formulation::add_internal_force() of the cells of a group, or of some of its batches. */
    virtual void add_force_of_group(const MechanicalInput &input, const Group &group,
                                    NodalVector &force) = 0;

    /** Formulation::apply_elastic_stiffness() of the cells of a group in their own step, which is
     * their ratio times @p time_step, times the square of the ratio: what bounds @p time_step. */
    virtual void apply_stiffness_of_group(const NodalVector &position, const NodalVector &velocity,
                                          double time_step, const Group &group,
                                          NodalVector &force) const = 0;
  };
} // namespace tombolo
