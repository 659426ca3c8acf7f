// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>

#include <tombolo/mesh/face_shapes.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /**
   * Faces of the boundary, in groups (one for each condition), and the areas of their nodes: s_k =
   * ∫ N_k dA over the faces of a group that this rank has, in given positions. The areas of a node
   * that several ranks have add up over them, and those of all nodes to the area of the group.
   * Likewise the outward areas ∫ N_k n dA of faces with an orientation.
   */
  template <int dim>
  class TributaryAreas
  {
  public:
    TributaryAreas(unsigned int n_groups, const Nodes<dim> &nodes);

    /** Adds a face with its nodes in the order of Nodes::face_places(). Each face is given by one
     * rank. @p orientation is 1 or -1 where the group has outward areas, see orientation(). */
    void add_face(unsigned int group, const std::vector<dealii::types::global_dof_index> &nodes,
                  double orientation = 0.);

    /** 1 where the normal that the nodes of a face at these places span leads away from @p inside,
     * a place in the body next to it, and -1 where it leads there. */
    double orientation(const std::vector<dealii::Point<dim>> &nodes,
                       const dealii::Point<dim> &inside) const;

    /** Removes the faces of these cells, each given by its nodes; set_partition() must follow. */
    void remove_faces_of(
        const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells);

    /** All nodes of the faces that this rank has or had. */
    dealii::IndexSet required_nodes() const;

    /** Translates node numbers to those of @p partition; areas are zero then. */
    void set_partition(const NodePartition &partition);

    /** Finds the areas in these positions (ghosts current). */
    void update(const NodalVector &position);

    /** Nodes of this rank's faces of a group, each once (local numbers, ghosts too). */
    const std::vector<unsigned int> &nodes(const unsigned int group) const
    {
      return groups[group].nodes;
    }

    /** The area of each of nodes() [L^(dim-1)]. */
    const std::vector<double> &areas(const unsigned int group) const
    {
      return groups[group].areas;
    }

    /** The outward area of each of nodes() [L^(dim-1)]; zero in groups without orientation. */
    const std::vector<dealii::Tensor<1, dim>> &outward_areas(const unsigned int group) const
    {
      return groups[group].outward_areas;
    }

    /** Owned nodes of the faces of all groups and ranks, ascending. Collective. */
    std::vector<unsigned int>
    owned_nodes(const std::shared_ptr<const NodePartition> &partition) const;

  private:
    struct Face
    {
      unsigned int group;
      std::vector<dealii::types::global_dof_index> global_nodes;
      std::vector<unsigned int> nodes;  ///< local
      std::vector<unsigned int> places; ///< in the list of nodes of its group
      double orientation = 0.;          ///< 0: its area has no direction
    };
    struct Group
    {
      std::vector<unsigned int> nodes;
      std::vector<double> areas;
      std::vector<dealii::Tensor<1, dim>> outward_areas;
    };

    std::vector<Face> faces;
    std::vector<Group> groups;
    dealii::IndexSet all_nodes;
    FaceShapes<dim> shapes;
  };
} // namespace tombolo
