// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <algorithm>
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
      marks.add_to_owners();
      marks.update_ghosts();
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
  } // namespace CellMarks
} // namespace tombolo
