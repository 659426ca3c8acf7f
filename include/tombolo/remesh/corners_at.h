// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <array>

namespace tombolo
{
  /** The corners of a cell with these local @p nodes, lexicographic, at @p position [L]. */
  template <int dim>
  typename SubCells<dim>::Corners
  corners_at(const std::array<unsigned int, SubCells<dim>::n_corners> &nodes,
             const NodalVector &position)
  {
    typename SubCells<dim>::Corners result;
    for (unsigned int k = 0; k < nodes.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        result[k][d] = position.node(nodes[k])[d];
    return result;
  }
} // namespace tombolo
