// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/boundary/region.h>
#include <tombolo/boundary/tributary_areas.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The conditions of one kind, a section "Condition: NAME" each, with the nodes and faces that
   * their places select. They prescribe some of the @p n_components of values at nodes. Of several
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

    /** The number of the condition that prescribes a component of a node, by its place in
     * constrained_nodes(), or a direction that has the place of a component; -1: none. */
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

    /** The first failure on this rank, empty for none: a function without a finite value. What was
     * to be computed is not complete then. Not agreed among ranks. */
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
        conditions.back().place.find_boundaries(mesh, section);
      }
    }

    template <typename IsWanted>
    bool has_type(const IsWanted &is_wanted) const
    {
      return std::any_of(conditions.begin(), conditions.end(),
                         [&](const Condition &condition) { return is_wanted(condition.type); });
    }

    /** Calls @p select, the value of a predicate in which can be undefined on one rank alone.
     * Throws InputError, then and where a condition has selected nothing. Collective. */
    template <typename Select>
    void find(const std::vector<Section> &sections, const Nodes<dim> &nodes, const Select &select)
    {
      attempt_on_all_ranks<InputError>(nodes.communicator(), select);
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (dealii::Utilities::MPI::sum(n_selected[c], nodes.communicator()) == 0)
          conditions[c].place.fail_empty(
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
          const Place<dim> &place = conditions[c].place;
          const auto select = [&](const unsigned int k)
          {
            if (!place.contains(cell_points[k]))
              return;
            n_selected[c] += nodes.owned().is_element(cell_nodes[k]) ? 1 : 0;
            action(c, cell_nodes[k], cell_points[k]);
          };
          if (is_on_faces(conditions[c].type))
            continue;
          if (!place.has_boundaries())
            for (unsigned int k = 0; k < cell_nodes.size(); ++k)
              select(k);
          else
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary() && place.has_boundary(cell->face(f)->boundary_id()))
                for (const unsigned int k : nodes.face_places(f))
                  select(k);
        }
      }
    }

    /** Calls action(cell, face, nodes, points) for the faces of owned cells at the boundary, with
     * the nodes of the face and their initial positions. */
    template <typename Action>
    void for_each_face(const Nodes<dim> &nodes, const Action &action)
    {
      std::vector<dealii::types::global_dof_index> cell_nodes, face_nodes;
      std::vector<dealii::Point<dim>> cell_points, face_points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned() || !cell->at_boundary())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        for (const unsigned int f : cell->face_indices())
        {
          if (!cell->face(f)->at_boundary())
            continue;
          face_nodes.clear();
          face_points.clear();
          for (const unsigned int k : nodes.face_places(f))
          {
            face_nodes.push_back(cell_nodes[k]);
            face_points.push_back(cell_points[k]);
          }
          action(cell, f, face_nodes, face_points);
        }
      }
    }

    /** Whether condition @p c, which is on faces, selects one; then it is counted. */
    bool selects_face(const unsigned int c, const Cell &cell, const unsigned int f)
    {
      const bool result =
          conditions[c].place.contains_face(cell->face(f)->boundary_id(), cell->face(f)->center());
      n_selected[c] += result ? 1 : 0;
      return result;
    }

    /** The entry of a node in a list of constraints, which it gets where it has none. */
    static Constraint &
    constraint_of(const dealii::types::global_dof_index node,
                  std::map<dealii::types::global_dof_index, Constraint> &of_nodes)
    {
      const auto [position, is_new] = of_nodes.try_emplace(node);
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
} // namespace tombolo
