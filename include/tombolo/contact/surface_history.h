// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /** The force of a rigid surface on a node, and where that was at the end of the step before. */
  template <int dim>
  struct SurfaceHistory
  {
    dealii::Tensor<1, dim> force;    ///< f [M L/T^2]
    dealii::Tensor<1, dim> position; ///< x [L]

    /** The nodes were placed anew, and were at @p before. */
    static void place(const std::vector<unsigned int> &nodes, const NodalVector &before,
                      const NodalVector &now, std::vector<SurfaceHistory> &histories)
    {
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          histories[k].position[d] += now.node(nodes[k])[d] - before.node(nodes[k])[d];
    }
  };
} // namespace tombolo
