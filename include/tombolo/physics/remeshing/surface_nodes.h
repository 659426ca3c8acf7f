// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/model/model.h>

#include <vector>

namespace tombolo
{
  /**
   * What the boundary of a part is like around its nodes. A node can slide where the boundary
   * around it is smooth at the start, has one boundary id, and is neither towards another part nor
   * on a plane of symmetry. It can slide as well where all of the boundary around it is towards
   * void cells.
   */
  template <int dim>
  class SurfaceNodes
  {
  public:
    /** @p lattice: the cells of the part on this rank, with their initial corners. Collective. */
    SurfaceNodes(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &lattice);

    /** Whether an owned node is on the boundary of the full cells. */
    bool is_on_boundary(const unsigned int node) const
    {
      return n_faces_of_nodes[node] > 0.;
    }

    /** Of an owned node: whether it can slide. */
    bool is_smooth(const unsigned int node) const
    {
      return smooth_nodes[node];
    }

  private:
    /** Adds what the boundary faces of the part say of their nodes. */
    static void examine_faces(const std::vector<SmoothedCell<dim>> &lattice, NodalVector &ids,
                              NodalVector &normals);

    std::vector<bool> smooth_nodes;       ///< of owned nodes
    std::vector<double> n_faces_of_nodes; ///< of owned nodes
  };
} // namespace tombolo
