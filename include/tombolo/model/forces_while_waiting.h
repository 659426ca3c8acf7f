// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/grouped_cells.h>
#include <tombolo/model/step_groups.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Forces of cells of elements that a rank can find while smoothed velocities are exchanged: all
   * of their nodes are its own, move alone (MassSplit::move_alone()) and depend on no others. These
   * cells come first on several ranks, whether there was time to wait or not, so that sums have one
   * order. On one rank there are none.
   */
  template <int dim>
  class ForcesWhileWaiting
  {
  public:
    /** To be called in each step before the smoothing; finds the cells where the model has changed.
     */
    void begin(const Model<dim> &model);

    /** Whether forces of some are not added yet. */
    bool are_left() const
    {
      return next < early.size();
    }

    /** Adds the forces of the next of these cells, so few @p as_a_piece that other ranks do
     * not wait for long. */
    void add_next(const MechanicalInput &input,
                  const typename StepGroups<dim>::Evaluation &evaluate, bool as_a_piece,
                  NodalVector &force);

    /** Whether there are such cells in a part, by its number. */
    bool are_in(std::size_t part) const;

    /** Formulation::add_internal_force() of the other cells of a part. */
    void add_rest_of(std::size_t part, const MechanicalInput &input, NodalVector &force) const;

  private:
    struct Cells
    {
      std::size_t part;
      GroupedCells<dim> *grouped_cells;
      typename GroupedCells<dim>::Group batches;
      unsigned int n_batches_of_piece;
    };

    void find_cells(const Model<dim> &model);

    std::vector<Cells> early, late;
    std::size_t next = 0;        // of the early ones
    unsigned int next_batch = 0; // within these
    // For which cells were found.
    std::shared_ptr<const NodePartition> partition;
    unsigned long revision = 0; // Revisions::cells
  };
} // namespace tombolo
