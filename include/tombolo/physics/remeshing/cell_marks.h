// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refilled_cells.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace tombolo
{
  /** The arguments of smoothed_cells_of() for a part, with these void cells if they are on. */
  template <int dim>
  PartSetup<dim> mesh_of_part(const Model<dim> &model, const unsigned int part,
                              const VoidCells<dim> *const voids = nullptr)
  {
    PartSetup<dim> setup;
    setup.index = part;
    setup.nodes = model.nodes.get();
    setup.part_cells = model.part_cells.get();
    setup.void_cells = voids != nullptr && voids->is_on() ? voids : nullptr;
    return setup;
  }

  /** Marks of nodes by the cells that have them. @p Nodes are the local numbers of the corners of
   * cells of this rank. */
  namespace CellMarks
  {
    template <typename Nodes>
    bool any_marked(const Nodes &cell_nodes, const NodalVector &marks)
    {
      return std::any_of(cell_nodes.begin(), cell_nodes.end(),
                         [&](const unsigned int node) { return *marks.node(node) > 0.; });
    }

    /** Scalar, with ghosts: positive at the nodes of the cells that are chosen, or of those that
     * are not. Collective. */
    template <typename Nodes>
    NodalVector nodes_of(const std::shared_ptr<const NodePartition> &partition,
                         const std::vector<Nodes> &nodes, const std::vector<bool> &is_chosen,
                         const bool marks_chosen = true)
    {
      return marked_nodes(partition,
                          [&](const auto &mark)
                          {
                            for (std::size_t c = 0; c < nodes.size(); ++c)
                              if (is_chosen[c] == marks_chosen)
                                std::for_each(nodes[c].begin(), nodes[c].end(), mark);
                          });
    }

    /** Which cells have a marked node. */
    template <typename Nodes>
    std::vector<bool> cells_marked(const std::vector<Nodes> &nodes, const NodalVector &marks)
    {
      std::vector<bool> result;
      for (const Nodes &cell_nodes : nodes)
        result.push_back(any_marked(cell_nodes, marks));
      return result;
    }

    /** Scalar, with ghosts: positive at the nodes of cells on whose faces or edges nodes of smaller
     * ones lie, and at these nodes. Collective. */
    template <int dim>
    NodalVector nodes_between_sizes(const std::vector<SmoothedCell<dim>> &cells,
                                    const std::shared_ptr<const NodePartition> &partition)
    {
      return marked_nodes(partition,
                          [&](const auto &mark)
                          {
                            for (const SmoothedCell<dim> &cell : cells)
                              if (cell.has_further_nodes())
                                for (const dealii::types::global_dof_index node : cell.all_nodes())
                                  mark(partition->local_index(node));
                          });
    }
  } // namespace CellMarks
} // namespace tombolo
