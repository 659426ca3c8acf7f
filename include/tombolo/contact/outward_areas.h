// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <vector>

namespace tombolo
{
  /**
   * The areas of nodes on the boundary of the mesh with their directions: S_k = ∫ N_k n dA over
   * outer faces (Nodes::is_outer_face), n out of the body, in given positions. What a node at an
   * edge of the body has on one of its sides is the part of S_k along the normal of that side.
   */
  template <int dim>
  class OutwardAreas
  {
  public:
    /** Takes the faces with these ids, or all if there are none. */
    OutwardAreas(const Nodes<dim> &nodes, const std::set<dealii::types::boundary_id> &boundaries);

    using IsVoid = std::function<bool(const typename Nodes<dim>::Cell &)>;

    /** Takes the faces that bound the cells that are not void; towards void cells only if there are
     * no ids. set_partition() must follow. */
    void take_faces(const Nodes<dim> &nodes, const IsVoid &is_void);

    /** Translates node numbers to those of @p partition, and forgets isolated nodes. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Faces with a node that has come off its body count no more. @p nodes are all such owned
     * nodes. Collective. */
    void set_isolated_nodes(const std::vector<unsigned int> &nodes);

    /** Finds the areas in these positions (ghosts current), if @p nodes are given only those of
     * these owned nodes. Collective. */
    void update(const NodalVector &position, const std::vector<unsigned int> *nodes = nullptr);

    /** S of an owned node [L^(dim-1)]. */
    dealii::Tensor<1, dim> area(const unsigned int node) const
    {
      return vector_of<dim>(sums.node(node));
    }

    /** Whether an owned node is on any of the faces that count, of any rank. */
    bool has_face(const unsigned int node) const
    {
      return is_on_face[node];
    }

  private:
    void find_nodes_on_faces();

    struct Face
    {
      std::vector<dealii::types::global_dof_index> global_nodes;
      std::vector<unsigned int> nodes; ///< local
      double orientation;              ///< 1 where the tangents give the normal out of the body
      bool counts = true;              ///< whether no node of it is isolated
    };

    std::set<dealii::types::boundary_id> boundaries;
    std::vector<Face> faces;
    FaceShapes<dim> shapes;
    NodalVector sums;
    std::vector<bool> is_on_face; ///< of owned nodes
    /** Buffer of update(): whether the areas of local nodes are needed. */
    std::vector<std::uint8_t> is_needed;
  };
} // namespace tombolo
