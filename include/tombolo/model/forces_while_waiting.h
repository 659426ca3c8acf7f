// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/grouped_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/model/step_groups.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
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
    void begin(const Model<dim> &model)
    {
      next = 0;
      next_batch = 0;
      const bool has_changed =
          partition != model.state.partition() || revision != model.revisions.cells;
      partition = model.state.partition();
      revision = model.revisions.cells;
      if (has_changed)
        find_cells(model);
    }

    /** Whether forces of some are not added yet. */
    bool are_left() const
    {
      return next < early.size();
    }

    /** Adds the forces of the next of these cells, so few @p as_a_piece that other ranks do
     * not wait for long. */
    void add_next(const MechanicalInput &input,
                  const typename StepGroups<dim>::Evaluation &evaluate, const bool as_a_piece,
                  NodalVector &force)
    {
      const Cells &cells = early[next];
      auto batches = cells.batches;
      batches.first_batch = std::max(batches.first_batch, next_batch);
      if (as_a_piece)
        batches.end_batch =
            std::min(batches.end_batch, batches.first_batch + cells.n_batches_of_piece);
      evaluate(cells.part, [&] { cells.grouped_cells->add_force_of_group(input, batches, force); });
      next_batch = batches.end_batch;
      if (next_batch == cells.batches.end_batch)
      {
        ++next;
        next_batch = 0;
      }
    }

    /** Whether there are such cells in a part, by its number. */
    bool are_in(const std::size_t part) const
    {
      return std::any_of(early.begin(), early.end(),
                         [&](const Cells &cells) { return cells.part == part; });
    }

    /** Formulation::add_internal_force() of the other cells of a part. */
    void add_rest_of(const std::size_t part, const MechanicalInput &input,
                     const typename StepGroups<dim>::Evaluation &evaluate, NodalVector &force) const
    {
      // Each has a failure of its own, which those after it do not know.
      for (const Cells &cells : late)
        if (cells.part == part)
          evaluate(part,
                   [&] { cells.grouped_cells->add_force_of_group(input, cells.batches, force); });
    }

  private:
    struct Cells
    {
      std::size_t part;
      GroupedCells<dim> *grouped_cells;
      typename GroupedCells<dim>::Group batches;
      unsigned int n_batches_of_piece;
    };

    void find_cells(const Model<dim> &model)
    {
      early.clear();
      late.clear();
      if (dealii::Utilities::MPI::n_mpi_processes(model.communicator) == 1 ||
          model.bridge->is_trace() || model.signals.part_force.is_connected() ||
          !model.step_groups.parts.empty())
        return;
      const unsigned int n_owned = partition->n_owned();
      const std::vector<bool> move_alone = model.bridge->mass_split().move_alone();
      const auto is_early = [&](const GroupedCells<dim> &cells, const unsigned int batch)
      {
        const std::vector<unsigned int> nodes = cells.nodes_of({1, batch, batch + 1});
        return std::all_of(nodes.begin(), nodes.end(),
                           [&](const unsigned int node)
                           { return node < n_owned && move_alone[node]; });
      };
      for (std::size_t p = 0; p < model.parts.size(); ++p)
      {
        auto *const grouped_cells = model.parts[p].template as<GroupedCells>();
        if (grouped_cells == nullptr)
          continue;
        // Some microseconds, and whole blocks of CellIntegration: fewer cells do not pay.
        constexpr unsigned int n_points_of_lane = 16;
        const unsigned int n_batches_of_piece = std::max(
            1u, n_points_of_lane / std::max(1u, model.parts[p].formulation->n_points_per_cell()));
        const unsigned int n_batches = grouped_cells->groups().front().end_batch;
        for (unsigned int begin = 0, end; begin < n_batches; begin = end)
        {
          const bool are_early = is_early(*grouped_cells, begin);
          for (end = begin + 1; end < n_batches && is_early(*grouped_cells, end) == are_early;
               ++end)
            ;
          const bool are_enough = are_early && end - begin >= n_batches_of_piece;
          if (!are_enough && !late.empty() && late.back().part == p &&
              late.back().batches.end_batch == begin)
            late.back().batches.end_batch = end;
          else
            (are_enough ? early : late)
                .push_back({p, grouped_cells, {1, begin, end}, n_batches_of_piece});
        }
      }
    }

    std::vector<Cells> early, late;
    std::size_t next = 0;        // of the early ones
    unsigned int next_batch = 0; // within these
    // For which cells were found.
    std::shared_ptr<const NodePartition> partition;
    unsigned long revision = 0; // Revisions::cells
  };
} // namespace tombolo
