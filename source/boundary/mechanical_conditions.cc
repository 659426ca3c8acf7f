// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/declarations.h>
#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/boundary/region.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    enum class ConditionType
    {
      traction,
      body_force,
      velocity,
      displacement,
      clamp
    };

    ConditionType type_of(const std::string &name)
    {
      if (name == "traction")
        return ConditionType::traction;
      if (name == "body force")
        return ConditionType::body_force;
      if (name == "velocity")
        return ConditionType::velocity;
      if (name == "displacement")
        return ConditionType::displacement;
      Assert(name == "clamp", ExcInternalError());
      return ConditionType::clamp;
    }

    bool prescribes(const ConditionType type)
    {
      return type == ConditionType::velocity || type == ConditionType::displacement ||
             type == ConditionType::clamp;
    }
  } // namespace

  template <int dim>
  struct MechanicalConditions<dim>::Condition
  {
    ConditionType type;
    Place<dim> place;
    std::optional<Expression<dim>> function;
  };

  template <int dim>
  struct MechanicalConditions<dim>::Selection
  {
    std::vector<unsigned long> n_selected; ///< owned nodes or faces, of each condition
    std::map<types::global_dof_index, Constraint> constraints;
  };

  template <int dim>
  void MechanicalConditions<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations section(handler);
    section.choice(
        "Type", mandatory,
        "traction|body force|velocity|displacement|clamp|symmetry|temperature|"
        "heat flux|convection|radiation|adiabatic|heat source",
        "What is prescribed. Of the motion: `traction` (force per current area, on faces of the "
        "boundary), `body force` (force per mass), `velocity`, `displacement`, `clamp` (no "
        "motion), or `symmetry` (the nodes that it selects are all those on one plane normal to an "
        "axis, beyond which the body is its own mirror image). Of heat: `temperature`; on faces of "
        "the boundary `heat flux` (into the body, per current area and time), `convection`, "
        "`radiation`, `adiabatic` (no heat passes, as without a condition); `heat source` (per "
        "initial volume and time).");
    section.text("Where", "", "",
                 "A predicate of the initial position, for example `x < 1e-9`. For what "
                 "acts on faces of the "
                 "boundary it selects these by their centre, otherwise nodes.");
    section.text("Boundary", "", "",
                 "Names of boundaries, separated by commas, instead of or together with "
                 "`Where`.");
    section.text(
        "Function", "", "",
        "Components separated by `;`, functions of the initial position x, y, z "
        "and of the time t. For a velocity or a displacement the word `free` leaves a "
        "component free. One value for a temperature, a heat flux or a heat source. Units: "
        "M/(L T^2) for a traction, L/T^2 for a body force, L/T for a velocity, L for a "
        "displacement, M/T^3 for a heat flux, M/(L T^3) for a heat source.");
  }

  template <int dim>
  typename MechanicalConditions<dim>::Condition
  MechanicalConditions<dim>::read(const Section &section)
  {
    const ConditionType type = type_of(section.get("Type"));
    Condition condition{type, Place<dim>(section, type == ConditionType::body_force), {}};
    if (type == ConditionType::body_force && !section.get("Boundary").empty())
      section.fail("Boundary", "a body force acts on the volume; use `Where`, or neither.");
    if (condition.type == ConditionType::clamp)
    {
      if (section.is_set("Function"))
        section.fail("Function", "a clamp needs no function; for a prescribed motion use `Type = "
                                 "velocity` or `displacement`.");
      return condition;
    }
    condition.function.emplace(section, "Function", dim, prescribes(condition.type));
    return condition;
  }

  template <int dim>
  void MechanicalConditions<dim>::validate(const Section &section)
  {
    read(section);
  }

  template <int dim>
  MechanicalConditions<dim>::MechanicalConditions(const std::vector<Section> &sections,
                                                  const Mesh<dim> &mesh, const Nodes<dim> &nodes)
      : areas(static_cast<unsigned int>(sections.size()), nodes), owned(nodes.owned())
  {
    for (const Section &section : sections)
    {
      Condition condition = read(section);
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
        conditions[c].place.fail_empty(sections[c], conditions[c].type == ConditionType::traction
                                                        ? "face of the boundary"
                                                        : "node");

    for (auto &[node, constraint] : selection.constraints)
      constraints.push_back(constraint);
  }

  template <int dim>
  void MechanicalConditions<dim>::select(const Nodes<dim> &nodes, const Cell &cell,
                                         Selection &selection)
  {
    std::vector<types::global_dof_index> cell_nodes, nodes_of_face;
    std::vector<Point<dim>> cell_points;
    nodes.cell_nodes(cell, cell_nodes);
    nodes.cell_points(cell, cell_points);
    for (unsigned int c = 0; c < conditions.size(); ++c)
      if (!conditions[c].place.has_boundaries() && conditions[c].type != ConditionType::traction)
        for (unsigned int k = 0; k < cell_nodes.size(); ++k)
          select_node(cell_nodes[k], cell_points[k], c, selection);
    for (const unsigned int f : cell->face_indices())
    {
      if (!cell->face(f)->at_boundary())
        continue;
      const types::boundary_id id = cell->face(f)->boundary_id();
      const std::vector<unsigned int> &face_nodes = nodes.face_places(f);
      nodes_of_face.clear();
      for (const unsigned int k : face_nodes)
        nodes_of_face.push_back(cell_nodes[k]);
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const Condition &condition = conditions[c];
        if (condition.type == ConditionType::traction)
        {
          if (!cell->is_locally_owned() ||
              !condition.place.contains_face(id, cell->face(f)->center()))
            continue;
          ++selection.n_selected[c];
          areas.add_face(c, nodes_of_face);
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
    const Condition &condition = conditions[c];
    if (!condition.place.contains(point) || !owned.is_element(node))
      return;
    ++selection.n_selected[c];
    if (!prescribes(condition.type))
      return;
    auto [position, is_new] = selection.constraints.try_emplace(node);
    if (is_new)
    {
      position->second.global_node = node;
      position->second.condition.fill(-1);
    }
    for (unsigned int d = 0; d < dim; ++d)
      if (condition.type == ConditionType::clamp || !condition.function->is_free(d))
        position->second.condition[d] = static_cast<int>(c);
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
  bool MechanicalConditions<dim>::has_loads() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const Condition &condition) { return !prescribes(condition.type); });
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_constraints() const
  {
    return std::any_of(conditions.begin(), conditions.end(),
                       [](const Condition &condition) { return prescribes(condition.type); });
  }

  template <int dim>
  std::vector<unsigned int> MechanicalConditions<dim>::loaded_nodes(const NodalState &state) const
  {
    std::vector<unsigned int> result = areas.owned_nodes(state.partition());
    for (const Condition &condition : conditions)
      if (condition.type == ConditionType::body_force)
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          if (condition.place.contains(point_of<dim>(state.initial_position.node(i))))
            result.push_back(i);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  template <int dim>
  void MechanicalConditions<dim>::compute_loads(const NodalState &state, const double time,
                                                NodalVector &loads,
                                                const NodalVector *const body_mass) const
  {
    const NodalVector &mass = body_mass != nullptr ? *body_mass : state.mass;
    loads.set_zero();
    areas.update(state.position);
    const auto add_tractions = [&]()
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
      {
        const std::vector<unsigned int> &nodes = areas.nodes(c);
        if (nodes.empty())
          continue;
        const Expression<dim> &function = *conditions[c].function;
        double traction[3] = {0, 0, 0};
        for (unsigned int k = 0; k < nodes.size(); ++k)
        {
          if (k == 0 || function.depends_on_place())
            for (unsigned int d = 0; d < dim; ++d)
              traction[d] =
                  function.value(point_of<dim>(state.initial_position.node(nodes[k])), time, d);
          for (unsigned int d = 0; d < dim; ++d)
            loads.node(nodes[k])[d] += traction[d] * areas.areas(c)[k];
        }
      }
    };
    const auto add_body_forces = [&]()
    {
      for (const Condition &condition : conditions)
        if (condition.type == ConditionType::body_force)
          for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          {
            const Point<dim> initial = point_of<dim>(state.initial_position.node(i));
            if (condition.place.contains(initial))
              for (unsigned int d = 0; d < dim; ++d)
                loads.node(i)[d] += *mass.node(i) * condition.function->value(initial, time, d);
          }
    };
    evaluate(add_tractions);
    loads.add_to_owners();
    evaluate(add_body_forces);
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
  double MechanicalConditions<dim>::prescribed_velocity(
      const Condition &condition, const Point<dim> &initial, const double *position,
      const unsigned int component, const double time, const double position_time_step) const
  {
    if (condition.type == ConditionType::clamp)
      return 0.;
    if (condition.type == ConditionType::velocity)
      return condition.function->value(initial, time + 0.5 * position_time_step, component);
    return (initial[component] +
            condition.function->value(initial, time + position_time_step, component) -
            position[component]) /
           position_time_step;
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
            const double target = prescribed_velocity(
                conditions[static_cast<unsigned int>(constraint.condition[d])],
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
            const Condition &condition =
                conditions[static_cast<unsigned int>(constraint.condition[d])];
            const Point<dim> initial = point_of<dim>(state.initial_position.node(constraint.node));
            state.unsmoothed_velocity.node(constraint.node)[d] =
                condition.type == ConditionType::displacement
                    ? (condition.function->value(initial, time + interval, d) -
                       condition.function->value(initial, time, d)) /
                          interval
                    : prescribed_velocity(condition, initial, state.position.node(constraint.node),
                                          d, time, 0.);
          }
    };
    evaluate(prescribe);
  }

  template class MechanicalConditions<2>;
  template class MechanicalConditions<3>;
} // namespace tombolo
