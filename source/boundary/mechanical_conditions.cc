// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/read_vector.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

namespace tombolo
{
  namespace
  {
    using Type = MechanicalConditionType;

    const std::pair<const char *, Type> mechanical_types[] = {{"traction", Type::traction},
                                                              {"pressure", Type::pressure},
                                                              {"body force", Type::body_force},
                                                              {"gravity", Type::gravity},
                                                              {"velocity", Type::velocity},
                                                              {"displacement", Type::displacement},
                                                              {"clamp", Type::clamp}};

    Type type_of(const std::string &name)
    {
      const auto *const type =
          std::find_if(std::begin(mechanical_types), std::end(mechanical_types),
                       [&](const auto &other) { return name == other.first; });
      Assert(type != std::end(mechanical_types), ExcInternalError());
      return type->second;
    }
  } // namespace

  bool prescribes(const MechanicalConditionType type)
  {
    return type == Type::velocity || type == Type::displacement || type == Type::clamp;
  }

  bool is_on_faces(const MechanicalConditionType type)
  {
    return type == Type::traction || type == Type::pressure;
  }

  bool is_on_volume(const MechanicalConditionType type)
  {
    return type == Type::body_force || type == Type::gravity;
  }

  template <int dim>
  void MechanicalCondition<dim>::declare_parameters(const Entries &e)
  {
    e.choice("Type", mandatory,
             "traction|pressure|body "
             "force|gravity|velocity|displacement|clamp|symmetry|temperature|heat "
             "flux|convection|radiation|adiabatic|heat source",
             "What is prescribed. Of the motion: `traction` (force per current area, on faces of "
             "the boundary, in a given direction), `pressure` (force per current area against the "
             "outward normal of the face as it is now), `body force` (force per mass), `gravity` "
             "(the same, of everything unless `Where` is given), `velocity`, `displacement`, "
             "`clamp` (no motion), or `symmetry` (the nodes that it selects are all those on one "
             "plane normal to an axis, beyond which the body is its own mirror image). Of heat: "
             "`temperature`; on faces of the boundary `heat flux` (into the body, per current area "
             "and time), `convection`, `radiation`, `adiabatic` (no heat passes, as without a "
             "condition); `heat source` (per initial volume and time).");
    e.text("Where", "", "",
           "A predicate of the initial position, for example `x < 1e-9`. For what acts on faces of "
           "the boundary it selects these by their centre, otherwise nodes.");
    e.text("Boundary", "", "",
           "Names of boundaries, separated by commas, instead of or together with `Where`.");
    e.text("Function", "",
           "M/(L T^2) for a traction or a pressure, L/T^2 for a body force or gravity, L/T for a "
           "velocity, L for a displacement, M/T^3 for a heat flux, M/(L T^3) for a heat source",
           "Components separated by `;`, functions of the initial position x, y, z and of the time "
           "t. For a velocity or a displacement the word `free` leaves a component free. "
           "`table(FILE, t)` takes values from a file of points. One value for a pressure, a "
           "temperature, a heat flux or a heat source.");
    e.text("Angle", "", "rad",
           "Of a displacement: the angle by which the nodes have turned about the axis at time t, "
           "from their initial positions; `Function` is added, and may be left out.");
    e.text("Axis", "0, 0, 1", "",
           "The direction of the axis of `Angle`; in two dimensions it is z.");
    e.text("Centre", dim == 2 ? "0, 0" : "0, 0, 0", "L", "A point of the axis of `Angle`.");
  }

  template <int dim>
  MechanicalCondition<dim> MechanicalCondition<dim>::read(const Section &section)
  {
    const Type type = type_of(section.get("Type"));
    MechanicalCondition condition{
        section.name(), type, Place<dim>(section, is_on_volume(type)), {}, {}};
    if (is_on_volume(type) && !section.get("Boundary").empty())
      section.fail("Boundary",
                   "a " + section.get("Type") + " acts on the volume; use `Where`, or neither.");
    if (type == Type::clamp)
    {
      if (section.is_set("Function"))
        section.fail("Function", "a clamp needs no function; for a prescribed motion use `Type = "
                                 "velocity` or `displacement`.");
      return condition;
    }
    const bool turns = section.is_set("Angle");
    for (const char *const entry : {"Angle", "Axis", "Centre"})
      if (section.is_set(entry) && !(turns && type == Type::displacement))
        section.fail(entry, "it is for `Type = displacement` with an `Angle`.");
    if (turns)
    {
      Tensor<1, 3> axis;
      axis[2] = 1.;
      if constexpr (dim == 3)
        axis = read_direction<3>(section, "Axis");
      else if (section.is_set("Axis"))
        section.fail("Axis", "two dimensions have none; nodes turn about `Centre`.");
      condition.turn.emplace(typename MechanicalCondition::Turn{
          {section, "Angle", 1}, read_vector<dim>(section, "Centre"), axis, {}, {}});
      if (condition.turn->angle.depends_on_place())
        section.fail("Angle", "allowed is a function of t.");
    }
    if (!turns || section.is_set("Function"))
      condition.function.emplace(section, "Function", type == Type::pressure ? 1 : dim,
                                 prescribes(type));
    return condition;
  }

  template <int dim>
  const Tensor<2, dim> &MechanicalCondition<dim>::Turn::rotation(const double time) const
  {
    using namespace Physics::Transformations::Rotations;
    if (time_of_rotation != time)
    {
      const double now = angle.value(Point<dim>(), time);
      if constexpr (dim == 2)
        last_rotation = rotation_matrix_2d(now);
      else
        last_rotation = rotation_matrix_3d(axis, now);
      time_of_rotation = time;
    }
    return last_rotation;
  }

  template <int dim>
  double MechanicalCondition<dim>::displacement(const Point<dim> &initial,
                                                const unsigned int component,
                                                const double time) const
  {
    const double shift = function ? function->value(initial, time, component) : 0.;
    if (!turn)
      return shift;
    const Tensor<1, dim> arm = initial - turn->centre;
    return turn->rotation(time)[component] * arm - arm[component] + shift;
  }

  template <int dim>
  double MechanicalCondition<dim>::prescribed_velocity(const Point<dim> &initial,
                                                       const double *const position,
                                                       const unsigned int component,
                                                       const double time,
                                                       const double time_step) const
  {
    if (type == Type::clamp)
      return 0.;
    if (type == Type::velocity)
      return function->value(initial, time + 0.5 * time_step, component);
    return (initial[component] + displacement(initial, component, time + time_step) -
            position[component]) /
           time_step;
  }

  template <int dim>
  double MechanicalCondition<dim>::initial_velocity(const Point<dim> &initial,
                                                    const double *const position,
                                                    const unsigned int component, const double time,
                                                    const double interval) const
  {
    if (type != Type::displacement)
      return prescribed_velocity(initial, position, component, time, 0.);
    return (displacement(initial, component, time + interval) -
            displacement(initial, component, time)) /
           interval;
  }

  template struct MechanicalCondition<2>;
  template struct MechanicalCondition<3>;

  template <int dim>
  MechanicalConditions<dim>::MechanicalConditions(const std::vector<Section> &sections,
                                                  const Mesh<dim> &mesh, const Nodes<dim> &nodes)
      : Base(sections, mesh, nodes)
  {
    using Constraint = typename Base::Constraint;
    std::map<types::global_dof_index, Constraint> of_nodes;
    // By node, component, and the two conditions.
    std::map<std::tuple<types::global_dof_index, unsigned int, unsigned int, unsigned int>,
             Point<dim>>
        shared;
    const auto select_node =
        [&](const unsigned int c, const types::global_dof_index node, const Point<dim> &point)
    {
      const MechanicalCondition<dim> &condition = conditions[c];
      if (!prescribes(condition.type) || !nodes.owned().is_element(node))
        return;
      Constraint &constraint = Base::constraint_of(node, of_nodes);
      const int number = static_cast<int>(c);
      for (unsigned int d = 0; d < dim; ++d)
        if (int &other = constraint.condition[d];
            !condition.function || !condition.function->is_free(d))
        {
          if (other >= 0 && other != number)
            shared.emplace(std::make_tuple(node, d,
                                           static_cast<unsigned int>(std::min(other, number)),
                                           static_cast<unsigned int>(std::max(other, number))),
                           point);
          other = std::max(other, number);
        }
    };
    const auto select_face =
        [&](const auto &cell, const unsigned int f, const auto &face_nodes, const auto &face_points)
    {
      for (unsigned int c = 0; c < conditions.size(); ++c)
        if (is_on_faces(conditions[c].type) && nodes.is_outer_face(cell, f) &&
            this->selects_face(c, cell, f))
          areas.add_face(c, face_nodes,
                         conditions[c].type == MechanicalConditionType::pressure
                             ? areas.orientation(face_points, cell->center())
                             : 0.);
    };
    this->find(sections, nodes,
               [&]
               {
                 this->for_each_node(nodes, select_node);
                 this->for_each_face(nodes, select_face);
               });
    for (const auto &[node, constraint] : of_nodes)
      constraints.push_back(constraint);
    for (const auto &[of, point] : shared)
      overlapping.push_back({std::get<2>(of), std::get<3>(of), std::get<1>(of), point});
  }

  template <int dim>
  IndexSet MechanicalConditions<dim>::prescribed_nodes() const
  {
    IndexSet result(areas.required_nodes().size());
    for (const auto &constraint : constraints)
      result.add_index(constraint.global_node);
    result.compress();
    return result;
  }

  template <int dim>
  bool MechanicalConditions<dim>::has_loads() const
  {
    return this->has_type([](const MechanicalConditionType type) { return !prescribes(type); });
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
      this->evaluate(action);
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
  template <typename Value>
  void MechanicalConditions<dim>::prescribe(NodalVector &vector, const Value &value) const
  {
    this->evaluate(
        [&]
        {
          for (std::size_t k = 0; k < constraints.size(); ++k)
            for (unsigned int d = 0; d < dim; ++d)
              if (const int c = constraints[k].condition[d]; c >= 0)
                vector.node(constraint_nodes[k])[d] =
                    value(conditions[static_cast<unsigned int>(c)], constraint_nodes[k], d);
        });
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_acceleration(NodalState &state, const double time,
                                                         const double velocity_time_step,
                                                         const double position_time_step) const
  {
    prescribe(state.acceleration,
              [&](const MechanicalCondition<dim> &condition, const unsigned int node,
                  const unsigned int d)
              {
                const double target = condition.prescribed_velocity(
                    point_of<dim>(state.initial_position.node(node)), state.position.node(node), d,
                    time, position_time_step);
                return (target - state.unsmoothed_velocity.node(node)[d]) / velocity_time_step;
              });
  }

  template <int dim>
  void MechanicalConditions<dim>::prescribe_initial_velocity(NodalState &state, const double time,
                                                             const double interval) const
  {
    const auto value = [&](const MechanicalCondition<dim> &condition, const unsigned int node,
                           const unsigned int d)
    {
      return condition.initial_velocity(point_of<dim>(state.initial_position.node(node)),
                                        state.position.node(node), d, time, interval);
    };
    // Every rank takes part in the exchange, also one where a function has failed.
    change_owned({&state.unsmoothed_velocity},
                 [&] { prescribe(state.unsmoothed_velocity, value); });
  }

  template class MechanicalConditions<2>;
  template class MechanicalConditions<3>;
} // namespace tombolo
