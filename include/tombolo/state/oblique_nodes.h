// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace tombolo
{
  /** A node of which directions are prescribed that are no axes: an orthonormal frame, some of
   * whose axes are prescribed. */
  struct ObliqueNode
  {
    unsigned int node;         ///< owned, a local number
    std::uint8_t prescribed;   ///< a bit for each axis of the frame
    dealii::Tensor<2, 3> axes; ///< by rows; the z axis comes last in two dimensions

    /** Removes the prescribed part of three components. */
    void remove_prescribed(double *const vector) const
    {
      for (unsigned int k = 0; k < 3; ++k)
        if ((prescribed >> k) & 1u)
        {
          double along = 0;
          for (unsigned int d = 0; d < 3; ++d)
            along += axes[k][d] * vector[d];
          for (unsigned int d = 0; d < 3; ++d)
            vector[d] -= axes[k][d] * along;
        }
    }
  };

  /** All such nodes of this rank. */
  class ObliqueNodes
  {
  public:
    ObliqueNodes() = default;

    /** @p nodes ascend. */
    explicit ObliqueNodes(std::vector<ObliqueNode> nodes) : rank_nodes(std::move(nodes)) {}

    /** The node with a local number; null where it is none of them. */
    const ObliqueNode *find(const unsigned int node) const
    {
      const auto found = std::lower_bound(rank_nodes.begin(), rank_nodes.end(), node,
                                          [](const ObliqueNode &one, const unsigned int number)
                                          { return one.node < number; });
      return found != rank_nodes.end() && found->node == node ? &*found : nullptr;
    }

    const std::vector<ObliqueNode> &all() const
    {
      return rank_nodes;
    }

  private:
    std::vector<ObliqueNode> rank_nodes;
  };
} // namespace tombolo
