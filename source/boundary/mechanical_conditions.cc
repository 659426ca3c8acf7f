// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/boundary/region.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  struct MechanicalConditions<dim>::Selection
  {
    std::vector<unsigned long> n_selected; ///< owned nodes or faces, of each condition
    std::map<types::global_dof_index, Constraint> constraints;
    /** By node, component, and the two conditions. */
    std::map<std::tuple<types::global_dof_index, unsigned int, unsigned int, unsigned int>,
             Point<dim>>
        overlaps;
  };

  template <int dim>
  void MechanicalConditions<dim>::declare_parameters(const Entries &e)
  {
    MechanicalCondition<dim>::declare_parameters(e);
  }

  template <int dim>
  void MechanicalConditions<dim>::validate(const Section &section)
  {
    MechanicalCondition<dim>::read(section);
  }

  template <int dim>
  MechanicalConditions<dim>::MechanicalConditions(const std::vector<Section> &sections,
                                                  const Mesh<dim> &mesh, const Nodes<dim> &nodes)
      : areas(static_cast<unsigned int>(sections.size()), nodes), owned(nodes.owned())
  {
    for (const Section &section : sections)
    {
      MechanicalCondition<dim> condition = MechanicalCondition<dim>::read(section);
      condition.place.find_boundaries(mesh, section);
      conditions.push_back(std::move(condition));
    }

    Selection selection;
    selection.n_selected.assign(conditions.size(), 0);
    // The value of a predicate can be undefined on one rank alone.
    std::string failure;
    try
    {
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        if (!cell->is_artificial())
          select(nodes, cell, selection);
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<InputError>(failure, nodes.communicator());

    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (Utilities::MPI::sum(selection.n_selected[c], nodes.communicator()) == 0)
        conditions[c].place.fail_empty(
            sections[c], is_on_faces(conditions[c].type) ? nodes.outer_face_text() : "node");

    for (auto &[node, constraint] : selection.constraints)
      constraints.push_back(constraint);
    for (const auto &[of, point] : selection.overlaps)
      overlapping.push_back({std::get<2>(of), std::get<3>(of), std::get<1>(of), point});
  }

  template <int dim>
  void MechanicalConditions<dim>::select(const Nodes<dim> &nodes, const Cell &cell,
                                         Selection &selection)
  {
    std::vector<types::global_dof_index> cell_nodes, nodes_of_face;
    std::vector<Point<dim>> cell_points, points_of_face;
    nodes.cell_nodes(cell, cell_nodes);
    nodes.cell_points(cell, cell_points);
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (!conditions[c].place.has_boundaries() && !is_on_faces(conditions[c].type))
        for (unsigned int k = 0; k < cell_nodes.size(); ++k)
          select_node(cell_nodes[k], cell_points[k], c, selection);
    for (const unsigned int f : cell->face_indices())
    {
      if (!cell->face(f)->at_boundary())
        continue;
      const types::boundary_id id = cell->face(f)->boundary_id();
      const std::vector<unsigned int> &face_nodes = nodes.face_places(f);
      nodes_of_face.clear();
      points_of_face.clear();
      for (const unsigned int k : face_nodes)
      {
        nodes_of_face.push_back(cell_nodes[k]);
        points_of_face.push_back(cell_points[k]);
      }
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const MechanicalCondition<dim> &condition = conditions[c];
        if (is_on_faces(condition.type))
        {
          if (!cell->is_locally_owned() || !nodes.is_outer_face(cell, f) ||
              !condition.place.contains_face(id, cell->face(f)->center()))
            continue;
          ++selection.n_selected[c];
          areas.add_face(c, nodes_of_face,
                         condition.type == MechanicalConditionType::pressure
                             ? areas.orientation(points_of_face, cell->center())
                             : 0.);
        }
        else if (condition.place.has_boundary(id))
          for (const unsigned int k : face_nodes)
            select_node(cell_nodes[k], cell_points[k], c, selection);
      }
    }
  }

  template <int dim>
  void MechanicalConditions<dim>::select_node(const types::global_dof_index node,
                                              const Point<dim> &point, const unsigned int c,
                                              Selection &selection) const
  {
    const MechanicalCondition<dim> &condition = conditions[c];
    if (!condition.place.contains(point) || !owned.is_element(node))
      return;
    ++selection.n_selected[c];
    if (!prescribes_motion(condition.type))
      return;
    auto [position, is_new] = selection.constraints.try_emplace(node);
    if (is_new)
    {
      position->second.global_node = node;
      position->second.condition.fill(-1);
    }
    for (unsigned int d = 0; d < dim; ++d)
      if (!condition.function || !condition.function->is_free(d))
        prescribe(c, d, point, position->second, selection);
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe(const unsigned int c, const unsigned int component,
                                            const Point<dim> &point, Constraint &constraint,
                                            Selection &selection)
  {
    int &condition = constraint.condition[component];
    const int number = static_cast<int>(c);
    if (condition >= 0 && condition != number)
      selection.overlaps.emplace(
          std::make_tuple(constraint.global_node, component,
                          static_cast<unsigned int>(std::min(condition, number)),
                          static_cast<unsigned int>(std::max(condition, number))),
          point);
    condition = std::max(condition, number);
  }

  template <int dim>
  const std::vector<typename MechanicalConditions<dim>::Overlap> &
  MechanicalConditions<dim>::overlaps() const
  {
    return overlapping;
  }

  template <int dim>
  MechanicalConditions<dim>::~MechanicalConditions() = default;

  template <int dim>
  IndexSet MechanicalConditions<dim>::required_nodes() const
  {
    return areas.required_nodes();
  }

  template <int dim>
  IndexSet MechanicalConditions<dim>::prescribed_nodes() const
  {
    IndexSet result(owned.size());
    for (const Constraint &constraint : constraints)
      result.add_index(constraint.global_node);
    result.compress();
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::set_partition(const NodePartition &partition)
  {
    areas.set_partition(partition);
    constrained.clear();
    constraint_nodes.clear();
    if (Utilities::MPI::max(constraints.empty() ? 0 : 1, partition.communicator()) == 0)
      return;
    constrained.assign(partition.n_owned(), 0);
    for (Constraint &constraint : constraints)
    {
      constraint.node = partition.local_index(constraint.global_node);
      constraint_nodes.push_back(constraint.node);
      for (unsigned int d = 0; d < dim; ++d)
        if (constraint.condition[d] >= 0)
          constrained[constraint.node] =
              static_cast<std::uint8_t>(constrained[constraint.node] | (1u << d));
    }
  }

  template <int dim>
  void MechanicalConditions<dim>::remove_faces(
      const std::vector<std::vector<types::global_dof_index>> &nodes_of_cells)
  {
    areas.remove_faces_of(nodes_of_cells);
  }

  template <int dim>
  const std::vector<std::uint8_t> &MechanicalConditions<dim>::constrained_components() const
  {
    return constrained;
  }

  template <int dim>
  const std::vector<unsigned int> &MechanicalConditions<dim>::constrained_nodes() const
  {
    return constraint_nodes;
  }

  template <int dim>
  int MechanicalConditions<dim>::prescribing_condition(const std::size_t constrained_node,
                                                       const unsigned int component) const
  {
    return component < dim ? constraints[constrained_node].condition[component] : -1;
  }

  template <int dim>
  const std::vector<MechanicalCondition<dim>> &MechanicalConditions<dim>::all() const
  {
    return conditions;
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_loads() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const MechanicalCondition<dim> &condition)
                       { return !prescribes_motion(condition.type); });
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_constraints() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const MechanicalCondition<dim> &condition)
                       { return prescribes_motion(condition.type); });
  }

  template <int dim>
  std::vector<unsigned int> MechanicalConditions<dim>::loaded_nodes(const NodalState &state) const
  {
    std::vector<unsigned int> result = areas.owned_nodes(state.partition());
    for (const MechanicalCondition<dim> &condition : conditions)
      if (is_on_volume(condition.type))
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          if (condition.place.contains(point_of<dim>(state.initial_position.node(i))))
            result.push_back(i);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::compute_loads(
      const NodalState &state, const double time, const NodalVector &places, NodalVector &loads,
      std::vector<LoadSum> &sums, const NodalVector &mass,
      const std::function<void(unsigned int, const NodalVector &)> &take_alone) const
  {
    loads.set_zero();
    sums.assign(conditions.size(), {});
    areas.update(state.position);
    NodalVector *const alone = take_alone ? &loads_alone : nullptr;
    if (alone != nullptr && alone->partition() != loads.partition())
      alone->reinit(loads.partition());
    // Every rank takes part in the exchange of a condition, also one where its function has failed.
    const auto add = [&](const unsigned int c, const std::function<void()> &action)
    {
      if (alone != nullptr)
        alone->set_zero();
      evaluate(action);
      if (alone == nullptr)
        return;
      alone->add_to_owners();
      take_alone(c, *alone);
    };
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (is_on_faces(conditions[c].type))
        add(c, [&]() { add_surface_forces(c, state, time, places, loads, sums[c], alone); });
    loads.add_to_owners();
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (is_on_volume(conditions[c].type))
        add(c, [&]()
            { add_body_forces(conditions[c], state, mass, time, places, loads, sums[c], alone); });
  }

  template <int dim>
  void MechanicalConditions<dim>::add_surface_forces(const unsigned int c, const NodalState &state,
                                                     const double time, const NodalVector &places,
                                                     NodalVector &loads, LoadSum &sum,
                                                     NodalVector *const alone) const
  {
    const std::vector<unsigned int> &nodes = areas.nodes(c);
    const Expression<dim> &function = *conditions[c].function;
    const bool is_pressure = conditions[c].type == MechanicalConditionType::pressure;
    double value[3] = {0, 0, 0};
    for (unsigned int k = 0; k < nodes.size(); ++k)
    {
      if (k == 0 || function.depends_on_place())
        for (unsigned int d = 0; d < function.n_components(); ++d)
          value[d] = function.value(point_of<dim>(state.initial_position.node(nodes[k])), time, d);
      double force[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
      {
        force[d] =
            is_pressure ? -value[0] * areas.outward_areas(c)[k][d] : value[d] * areas.areas(c)[k];
        loads.node(nodes[k])[d] += force[d];
        if (alone != nullptr)
          alone->node(nodes[k])[d] += force[d];
      }
      sum.add(places.node(nodes[k]), force);
    }
  }

  template <int dim>
  void MechanicalConditions<dim>::add_body_forces(const MechanicalCondition<dim> &condition,
                                                  const NodalState &state, const NodalVector &mass,
                                                  const double time, const NodalVector &places,
                                                  NodalVector &loads, LoadSum &sum,
                                                  NodalVector *const alone) const
  {
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      const Point<dim> initial = point_of<dim>(state.initial_position.node(i));
      if (!condition.place.contains(initial))
        continue;
      double force[3] = {0, 0, 0};
      for (unsigned int d = 0; d < dim; ++d)
      {
        force[d] = *mass.node(i) * condition.function->value(initial, time, d);
        loads.node(i)[d] += force[d];
        if (alone != nullptr)
          alone->node(i)[d] += force[d];
      }
      sum.add(places.node(i), force);
    }
  }

  template <int dim>
  void MechanicalConditions<dim>::evaluate(const std::function<void()> &action) const
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

  template <int dim>
  const std::string &MechanicalConditions<dim>::failure() const
  {
    return local_failure;
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_acceleration(NodalState &state, const double time,
                                                         const double velocity_time_step,
                                                         const double position_time_step) const
  {
    const auto prescribe = [&]()
    {
      for (const Constraint &constraint : constraints)
        for (unsigned int d = 0; d < dim; ++d)
          if (constraint.condition[d] >= 0)
          {
            const double target =
                conditions[static_cast<unsigned int>(constraint.condition[d])].prescribed_velocity(
                    point_of<dim>(state.initial_position.node(constraint.node)),
                    state.position.node(constraint.node), d, time, position_time_step);
            state.acceleration.node(constraint.node)[d] =
                (target - state.unsmoothed_velocity.node(constraint.node)[d]) / velocity_time_step;
          }
    };
    evaluate(prescribe);
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_initial_velocity(NodalState &state, const double time,
                                                             const double interval) const
  {
    const auto prescribe = [&]()
    {
      for (const Constraint &constraint : constraints)
        for (unsigned int d = 0; d < dim; ++d)
          if (constraint.condition[d] >= 0)
          {
            const MechanicalCondition<dim> &condition =
                conditions[static_cast<unsigned int>(constraint.condition[d])];
            state.unsmoothed_velocity.node(constraint.node)[d] = condition.initial_velocity(
                point_of<dim>(state.initial_position.node(constraint.node)),
                state.position.node(constraint.node), d, time, interval);
          }
    };
    // Every rank takes part in the exchange, also one where a function has failed.
    change_owned({&state.unsmoothed_velocity}, [&] { evaluate(prescribe); });
  }

  template class MechanicalConditions<2>;
  template class MechanicalConditions<3>;
} // namespace tombolo
