// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/region.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
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
    struct Group
    {
      std::vector<unsigned int> nodes; ///< of this rank's faces, each once (local, ghosts too)
      std::vector<double> areas;       ///< of each of them [L^(dim-1)]
      std::vector<dealii::Tensor<1, dim>> outward_areas; ///< likewise; zero without orientation
      std::vector<unsigned int> index_of_node; ///< of each local node in nodes; invalid: none
      bool is_initial = false;                 ///< areas are those of the initial positions
    };

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

    /** Adds a face with its nodes in the order of Nodes::face_node_indices(). Each face is added by
     * one rank. @p orientation is 1 or -1 where the group has outward areas, see orientation(). */
    void add_face(unsigned int group, const std::vector<dealii::types::global_dof_index> &nodes,
                  double orientation = 0.)
    {
      AssertIndexRange(group, groups.size());
      AssertDimension(nodes.size(), shapes.n_nodes);
      faces.push_back({group, nodes, {}, {}, orientation});
      for (const dealii::types::global_dof_index node : nodes)
        all_nodes.add_index(node);
    }

    /** 1 where the normal that the nodes of a face at these positions span is directed away from
     * @p inside, a point in the body next to it, and -1 where it is directed there. */
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
        group.index_of_node.assign(partition.n_local(), dealii::numbers::invalid_unsigned_int);
      }
      for (Face &face : faces)
      {
        face.nodes.clear();
        face.indices.clear();
        Group &group = groups[face.group];
        for (const dealii::types::global_dof_index global_node : face.global_nodes)
        {
          const unsigned int node = partition.local_index(global_node);
          unsigned int &index = group.index_of_node[node];
          if (index == dealii::numbers::invalid_unsigned_int)
          {
            index = static_cast<unsigned int>(group.nodes.size());
            group.nodes.push_back(node);
          }
          face.nodes.push_back(node);
          face.indices.push_back(index);
        }
      }
      for (Group &group : groups)
      {
        group.areas.assign(group.nodes.size(), 0.);
        group.outward_areas.assign(group.nodes.size(), dealii::Tensor<1, dim>());
      }
    }

    /** Finds the areas in these positions (ghosts current), or in the initial ones of a group. */
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
          group.areas[face.indices[k]] += face_areas[k][node_stride - 1];
          for (unsigned int d = 0; face.orientation != 0. && d < dim; ++d)
            group.outward_areas[face.indices[k]][d] += face.orientation * face_areas[k][d];
        }
      }
    }

    const Group &group(const unsigned int number) const
    {
      return groups[number];
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
      std::vector<unsigned int> nodes;   ///< local
      std::vector<unsigned int> indices; ///< in the list of nodes of its group
      double orientation = 0.;           ///< 0: its area has no direction
    };
    /** ∫ N_k n dA and, in the last slot, ∫ N_k dA of a face with these nodes, for its nodes. */
    void find_areas(const NodalVector &position, const std::vector<unsigned int> &nodes)
    {
      face_areas.resize_fast(shapes.n_nodes);
      face_areas.fill(NodeLanes(0.));
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
          face_areas[k] += normal * (shapes.weights[q] * shapes.value(q, k));
      }
    }

    std::vector<Face> faces;
    std::vector<Group> groups;
    dealii::AlignedVector<NodeLanes> face_areas; // of the last face
    dealii::IndexSet all_nodes;
    FaceShapes<dim> shapes;
  };

  /**
   * The conditions of one kind, a section "Condition: NAME" each, with the nodes and faces that
   * their regions select. They prescribe some of the @p n_components of values at nodes. Of several
   * conditions that prescribe a component, as at an edge, the last one does it.
   */
  template <int dim, typename Condition, unsigned int n_components>
  class Conditions
  {
  public:
    /** All conditions, by their number. */
    const std::vector<Condition> &all() const
    {
      return conditions;
    }

    unsigned int n_conditions() const
    {
      return static_cast<unsigned int>(conditions.size());
    }

    /** Nodes whose values this rank needs: those of its faces with conditions. */
    dealii::IndexSet required_nodes() const
    {
      return areas.required_nodes();
    }

    /** Translates node numbers to those of @p partition. */
    void set_partition(const NodePartition &partition)
    {
      areas.set_partition(partition);
      constrained.clear();
      constraint_nodes.clear();
      if (dealii::Utilities::MPI::max(constraints.empty() ? 0 : 1, partition.communicator()) == 0)
        return;
      constrained.assign(partition.n_owned(), 0);
      for (const Constraint &constraint : constraints)
      {
        const unsigned int node = partition.local_index(constraint.global_node);
        constraint_nodes.push_back(node);
        for (unsigned int d = 0; d < n_components; ++d)
          if (constraint.condition[d] >= 0 && !constraint.is_turned[d])
            constrained[node] = static_cast<std::uint8_t>(
                n_components == 1 ? std::numeric_limits<std::uint8_t>::max()
                                  : constrained[node] | (1u << d));
      }
    }

    /** Conditions no longer act on the faces of these cells, each given by its nodes.
     * set_partition() must follow. */
    void
    remove_faces(const std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells)
    {
      areas.remove_faces_of(nodes_of_cells);
    }

    /** A bit per component of each owned node that is prescribed, all bits where there is one
     * component; empty where nothing is, on any rank. Not of directions that are no axes. */
    const std::vector<std::uint8_t> &constrained_components() const
    {
      return constrained;
    }

    /** Owned constrained nodes (local numbers), in the order of their global numbers. */
    const std::vector<unsigned int> &constrained_nodes() const
    {
      return constraint_nodes;
    }

    /** The number of the condition that prescribes a component of a node, by its index in
     * constrained_nodes(), or a direction in the slot of a component; -1: none. */
    int prescribing_condition(const std::size_t constrained_node,
                              const unsigned int component) const
    {
      return component < n_components ? constraints[constrained_node].condition[component] : -1;
    }

    /** Whether a condition prescribes something, on this rank or on another. */
    bool has_constraints() const
    {
      return has_type([](const auto type) { return prescribes(type); });
    }

    /** The first failure on this rank, empty for none: a function without a finite value. The
     * result is not complete then. Not agreed among ranks. */
    const std::string &failure() const
    {
      return local_failure;
    }

  protected:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;

    struct Constraint
    {
      dealii::types::global_dof_index global_node;
      std::array<int, n_components> condition; ///< which prescribes the component, or -1
      /** Whether it does so along a direction that is no axis. */
      std::array<bool, n_components> is_turned{};
    };

    /** Reads them: Condition::read(section, arguments...). Throws InputError. */
    template <typename... Arguments>
    Conditions(const std::vector<Section> &sections, const Mesh<dim> &mesh, const Nodes<dim> &nodes,
               const Arguments &...arguments)
        : areas(static_cast<unsigned int>(sections.size()), nodes), n_selected(sections.size(), 0)
    {
      for (const Section &section : sections)
      {
        conditions.push_back(Condition::read(section, arguments...));
        conditions.back().region.find_boundaries(mesh, section);
      }
    }

    template <typename Matches>
    bool has_type(const Matches &matches) const
    {
      return std::any_of(conditions.begin(), conditions.end(),
                         [&](const Condition &condition) { return matches(condition.type); });
    }

    /** Calls @p select, the value of a predicate in which can be undefined on one rank alone.
     * Throws InputError, then and where a condition has selected nothing. Collective. */
    template <typename Select>
    void find(const std::vector<Section> &sections, const Nodes<dim> &nodes, const Select &select)
    {
      attempt_on_all_ranks<InputError>(nodes.communicator(), select);
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (dealii::Utilities::MPI::sum(n_selected[c], nodes.communicator()) == 0)
          conditions[c].region.fail_empty(
              sections[c], is_on_faces(conditions[c].type) ? nodes.outer_face_text() : "node");
    }

    /** Calls action(condition, node, point) for the owned and ghost nodes that conditions select
     * which are not on faces, some of them repeatedly. */
    template <typename Action>
    void for_each_node(const Nodes<dim> &nodes, const Action &action)
    {
      std::vector<dealii::types::global_dof_index> cell_nodes;
      std::vector<dealii::Point<dim>> cell_points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        for (unsigned int c = 0; c < conditions.size(); ++c)
        {
          const Region<dim> &region = conditions[c].region;
          const auto select = [&](const unsigned int k)
          {
            if (!region.contains(cell_points[k]))
              return;
            n_selected[c] += nodes.owned().is_element(cell_nodes[k]) ? 1 : 0;
            action(c, cell_nodes[k], cell_points[k]);
          };
          if (is_on_faces(conditions[c].type))
            continue;
          if (!region.has_boundaries())
            for (unsigned int k = 0; k < cell_nodes.size(); ++k)
              select(k);
          else
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary() && region.has_boundary(cell->face(f)->boundary_id()))
                for (const unsigned int k : nodes.face_node_indices(f))
                  select(k);
        }
      }
    }

    static bool is_at_boundary(const Cell &cell, const unsigned int face)
    {
      return cell->at_boundary(face);
    }

    /** Whether condition @p c, which is on faces, selects one; then it is counted. */
    bool selects_face(const unsigned int c, const Cell &cell, const unsigned int f)
    {
      const bool result =
          conditions[c].region.contains_face(cell->face(f)->boundary_id(), cell->face(f)->center());
      n_selected[c] += result ? 1 : 0;
      return result;
    }

    /** The entry of a node in a list of constraints, which is added where there is none. */
    static Constraint &
    constraint_of(const dealii::types::global_dof_index node,
                  std::map<dealii::types::global_dof_index, Constraint> &constraints_by_node)
    {
      const auto [position, is_new] = constraints_by_node.try_emplace(node);
      if (is_new)
      {
        position->second.global_node = node;
        position->second.condition.fill(-1);
      }
      return position->second;
    }

    /** Does @p action; a RunError of it becomes the failure() of this rank. */
    template <typename Action>
    void evaluate(const Action &action) const
    {
      try
      {
        action();
      }
      catch (const RunError &error)
      {
        if (local_failure.empty())
          local_failure = error.what();
      }
    }

    std::vector<Condition> conditions;
    mutable TributaryAreas<dim> areas;          ///< by condition
    std::vector<Constraint> constraints;        ///< of owned nodes, ascending
    std::vector<unsigned int> constraint_nodes; ///< local numbers of theirs

  private:
    std::vector<unsigned long> n_selected; ///< owned nodes or faces, by condition
    std::vector<std::uint8_t> constrained;
    mutable std::string local_failure;
  };

  extern template class TributaryAreas<2>;
  extern template class TributaryAreas<3>;
} // namespace tombolo
