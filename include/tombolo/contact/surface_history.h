// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/state_archive.h>

#include <deal.II/base/tensor.h>

#include <array>
#include <string>
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

    /** Writes the positions of before, of other nodes the present ones @p now, for another mesh, or
     * reads them there: of a new node the mean of those between which it lies. Returns those of all
     * nodes. Collective. */
    static NodalVector follow_division(StateArchive &archive, const std::string &contact,
                                       const std::vector<unsigned int> &nodes,
                                       const NodalVector &now,
                                       std::vector<SurfaceHistory> &histories)
    {
      const auto group = archive.group("division of contact " + contact);
      NodalVector before(now.partition(), Quantity::position);
      before.copy_from(now);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          before.node(nodes[k])[d] = histories[k].position[d];
      archive.nodal("position", dim, before);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          histories[k].position[d] = before.node(nodes[k])[d];
      return before;
    }

    /** Writes those of owned @p nodes to a checkpoint or reads them from it. Collective. */
    static void serialize(StateArchive &archive, const std::vector<unsigned int> &nodes,
                          std::vector<SurfaceHistory> &histories)
    {
      std::vector<std::array<double, 3>> forces(nodes.size()), positions(nodes.size());
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          forces[k][d] = histories[k].force[d];
          positions[k][d] = histories[k].position[d];
        }
      archive.nodal("force", nodes, forces);
      archive.nodal("position", nodes, positions);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          histories[k].force[d] = forces[k][d];
          histories[k].position[d] = positions[k][d];
        }
    }
  };
} // namespace tombolo
