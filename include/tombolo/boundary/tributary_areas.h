// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/index_set.h>

#include <tombolo/base/simd/cross_product.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
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
    TributaryAreas(const unsigned int n_groups, const Nodes<dim> &nodes)
        : groups(n_groups), all_nodes(nodes.owned().size()),
          shapes(nodes.degree(), nodes.degree() + 1)
    {}

    /** Whether areas of this group are those of the initial positions. */
    void keep_initial(const unsigned int group, const bool is_kept)
    {
      AssertIndexRange(group, groups.size());
      groups[group].is_initial = is_kept;
    }

    /** Adds a face with its nodes in the order of Nodes::face_places(). Each face is given by one
     * rank. @p orientation is 1 or -1 where the group has outward areas, see orientation(). */
    void add_face(unsigned int group, const std::vector<dealii::types::global_dof_index> &nodes,
                  double orientation = 0.)
    {
      AssertIndexRange(group, groups.size());
      AssertDimension(nodes.size(), shapes.n_nodes);
      faces.push_back({group, nodes, {}, {}, orientation});
      for (const dealii::types::global_dof_index node : nodes)
        all_nodes.add_index(node);
    }

    /** 1 where the normal that the nodes of a face at these places span leads away from @p inside,
     * a place in the body next to it, and -1 where it leads there. */
    double orientation(const std::vector<dealii::Point<dim>> &nodes,
                       const dealii::Point<dim> &inside) const
    {
      dealii::Tensor<1, dim> normal, centre;
      for (const dealii::Point<dim> &node : nodes)
        centre += node / static_cast<double>(nodes.size());
      for (unsigned int q = 0; q < shapes.weights.size(); ++q)
        normal +=
            shapes.weights[q] * shapes.normal(q, [&](const unsigned int k) { return nodes[k]; });
      return normal * (centre - inside) > 0. ? 1. : -1.;
    }

    /** Removes the faces of these cells, each given by its nodes; set_partition() must follow. */
    void
    remove_faces_of(const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells)
    {
      std::multimap<dealii::types::global_dof_index,
                    const std::vector<dealii::types::global_dof_index> *>
          cell_of;
      for (const auto &cell : nodes_of_cells)
        for (const dealii::types::global_dof_index node : cell)
          cell_of.emplace(node, &cell);
      const auto is_of_cell =
          [](const Face &face, const std::vector<dealii::types::global_dof_index> &cell)
      {
        return std::all_of(face.global_nodes.begin(), face.global_nodes.end(),
                           [&](const dealii::types::global_dof_index node)
                           { return std::find(cell.begin(), cell.end(), node) != cell.end(); });
      };
      const auto is_removed = [&](const Face &face)
      {
        const auto candidates = cell_of.equal_range(face.global_nodes.front());
        return std::any_of(candidates.first, candidates.second,
                           [&](const auto &entry) { return is_of_cell(face, *entry.second); });
      };
      faces.erase(std::remove_if(faces.begin(), faces.end(), is_removed), faces.end());
    }

    /** All nodes of the faces that this rank has or had. */
    dealii::IndexSet required_nodes() const
    {
      dealii::IndexSet result = all_nodes;
      result.compress();
      return result;
    }

    /** Translates node numbers to those of @p partition; areas are zero then. */
    void set_partition(const NodePartition &partition)
    {
      for (Group &group : groups)
      {
        group.nodes.clear();
        group.place_of_node.assign(partition.n_local(), dealii::numbers::invalid_unsigned_int);
      }
      for (Face &face : faces)
      {
        face.nodes.clear();
        face.places.clear();
        Group &group = groups[face.group];
        for (const dealii::types::global_dof_index global_node : face.global_nodes)
        {
          const unsigned int node = partition.local_index(global_node);
          unsigned int &place = group.place_of_node[node];
          if (place == dealii::numbers::invalid_unsigned_int)
          {
            place = static_cast<unsigned int>(group.nodes.size());
            group.nodes.push_back(node);
          }
          face.nodes.push_back(node);
          face.places.push_back(place);
        }
      }
      for (Group &group : groups)
      {
        group.areas.assign(group.nodes.size(), 0.);
        group.outward_areas.assign(group.nodes.size(), dealii::Tensor<1, dim>());
      }
    }

    /** Finds the areas in these positions (ghosts current). */
    void update(const NodalVector &position)
    {
      update(position, position);
    }

    /** The same, but in the initial positions where a group keeps these. */
    void update(const NodalVector &position, const NodalVector &initial_position)
    {
      for (Group &group : groups)
      {
        std::fill(group.areas.begin(), group.areas.end(), 0.);
        std::fill(group.outward_areas.begin(), group.outward_areas.end(), dealii::Tensor<1, dim>());
      }
      const Face *last = nullptr;
      for (const Face &face : faces)
      {
        Group &group = groups[face.group];
        // The groups of a face have it one after the other.
        if (last == nullptr || last->nodes != face.nodes ||
            groups[last->group].is_initial != group.is_initial)
          find_areas(group.is_initial ? initial_position : position, face.nodes);
        last = &face;
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
        {
          group.areas[face.places[k]] += of_face[k][node_stride - 1];
          for (unsigned int d = 0; face.orientation != 0. && d < dim; ++d)
            group.outward_areas[face.places[k]][d] += face.orientation * of_face[k][d];
        }
      }
    }

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
    owned_nodes(const std::shared_ptr<const NodePartition> &partition) const
    {
      return owned_marked_nodes(partition,
                                [&](const auto &mark)
                                {
                                  for (const Group &group : groups)
                                    std::for_each(group.nodes.begin(), group.nodes.end(), mark);
                                });
    }

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
      std::vector<unsigned int> place_of_node; ///< of each local node in nodes; invalid: none
      std::vector<double> areas;
      std::vector<dealii::Tensor<1, dim>> outward_areas;
      bool is_initial = false; ///< areas are those of the initial positions
    };

    /** ∫ N_k n dA and, in the last slot, ∫ N_k dA of a face with these nodes, for its nodes. */
    void find_areas(const NodalVector &position, const std::vector<unsigned int> &nodes)
    {
      of_face.resize_fast(shapes.n_nodes);
      of_face.fill(NodeLanes(0.));
      for (unsigned int q = 0; q < shapes.weights.size(); ++q)
      {
        NodeLanes tangents[2] = {0., 0.};
        for (unsigned int d = 0; d < dim - 1; ++d)
          for (unsigned int k = 0; k < shapes.n_nodes; ++k)
            tangents[d] += load_node(position.node(nodes[k])) * shapes.derivative(q, d, k);
        NodeLanes normal = dim == 2 ? node_of(tangents[0][1], -tangents[0][0], 0.)
                                    : cross_product(tangents[0], tangents[1]);
        const NodeLanes squares = normal * normal;
        normal[node_stride - 1] = std::sqrt(squares[0] + squares[1] + squares[2]);
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
          of_face[k] += normal * (shapes.weights[q] * shapes.value(q, k));
      }
    }

    std::vector<Face> faces;
    std::vector<Group> groups;
    dealii::AlignedVector<NodeLanes> of_face; // of the last face
    dealii::IndexSet all_nodes;
    FaceShapes<dim> shapes;
  };
} // namespace tombolo
