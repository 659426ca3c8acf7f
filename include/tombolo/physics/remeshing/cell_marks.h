// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Marks of nodes by the cells that have them. @p Nodes are the local numbers of the corners of
   * cells of this rank. */
  namespace CellMarks
  {
    template <typename Nodes>
    bool any_marked(const Nodes &of_cell, const NodalVector &marks)
    {
      return std::any_of(of_cell.begin(), of_cell.end(),
                         [&](const unsigned int node) { return *marks.node(node) > 0.; });
    }

    /** Marks the nodes of the cells that are chosen, or of those that are not, in @p marks
     * (scalar), whose ghosts are current then. Collective. */
    template <typename Nodes>
    void mark(const std::vector<Nodes> &of_cells, const std::vector<bool> &is_chosen,
              const bool of_chosen, NodalVector &marks)
    {
      for (std::size_t c = 0; c < of_cells.size(); ++c)
        if (is_chosen[c] == of_chosen)
          for (const unsigned int node : of_cells[c])
            *marks.node(node) = 1.;
      marks.sum_over_ranks();
    }

    /** Which cells have a marked node. */
    template <typename Nodes>
    std::vector<bool> cells_marked(const std::vector<Nodes> &of_cells, const NodalVector &marks)
    {
      std::vector<bool> result;
      for (const Nodes &of_cell : of_cells)
        result.push_back(any_marked(of_cell, marks));
      return result;
    }

    /** Scalar, with ghosts: positive at the nodes of cells on whose faces or edges nodes of smaller
     * ones lie, and at these nodes. Collective. */
    template <int dim>
    NodalVector nodes_between_sizes(const std::vector<SmoothedCell<dim>> &cells,
                                    const std::shared_ptr<const NodePartition> &partition)
    {
      NodalVector result;
      result.reinit(partition, Quantity::scalar);
      for (const SmoothedCell<dim> &cell : cells)
        if (cell.has_further_nodes())
          for (const dealii::types::global_dof_index node : cell.all_nodes())
            *result.node(partition->local_index(node)) = 1.;
      result.sum_over_ranks();
      return result;
    }
  } // namespace CellMarks
} // namespace tombolo
