// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/mechanical_conditions.h>

#include <tombolo/base/input/read_vector.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <iterator>
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
             "What is prescribed. Of the motion: `traction` (force per area, on faces of "
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
    e.text(
        "Axis", "0, 0, 1", "",
        "The direction of the axis of `Angle`, or of cylindrical `Axes`; in two dimensions it is "
        "z.");
    e.text("Centre", dim == 2 ? "0, 0" : "0, 0, 0", "L", "A point of this axis.");
    LocalAxes<dim>::declare_parameters(e);
    e.choice(
        "Area", "current", "current|initial",
        "Of a traction: it is the force per area of the faces as they are now, or as they were "
        "at the start. With `initial` forces stay what they are while faces stretch.");
    e.optional_number(
        "Start", zero_or_positive(), "T",
        "Of a condition of the motion or a load: it acts from this time on; empty is "
        "the beginning. A displacement then adds its changes since, wherever the nodes "
        "are.");
    e.optional_number(
        "End", positive(), "T",
        "Of the same: from this time on it does not act, and nodes are free; empty is "
        "never.");
  }

  template <int dim>
  MechanicalCondition<dim> MechanicalCondition<dim>::read(const Section &section)
  {
    const Type type = type_of(section.get("Type"));
    MechanicalCondition condition{
        section.name(), type, Region<dim>(section, is_on_volume(type)), {}, {}, {}};
    if (is_on_volume(type) && !section.get("Boundary").empty())
      section.fail("Boundary",
                   "a " + section.get("Type") + " acts on the volume; use `Where`, or neither.");
    condition.read_times(section);
    condition.has_initial_areas = section.get("Area") == "initial";
    if (condition.has_initial_areas && type != Type::traction)
      section.fail("Area", "it is for a traction.");
    const bool has_axes = section.is_set("Axes");
    if (has_axes && (type == Type::clamp || type == Type::pressure))
      section.fail("Axes",
                   "it is for a velocity, a displacement, a traction or a body force, which "
                   "have components.");
    if (type == Type::clamp)
    {
      if (section.is_set("Function"))
        section.fail("Function", "a clamp needs no function; for a prescribed motion use `Type = "
                                 "velocity` or `displacement`.");
      return condition;
    }
    const bool turns = section.is_set("Angle");
    if (turns && has_axes)
      section.fail("Axes", "a displacement with an `Angle` is along the axes of the coordinates.");
    const bool is_cylindrical = section.get("Axes") == "cylindrical";
    for (const char *const entry : {"Angle", "Axis", "Centre"})
      if (section.is_set(entry) && !(turns && type == Type::displacement) &&
          !(is_cylindrical && std::string(entry) != "Angle"))
        section.fail(entry, "it is for `Type = displacement` with an `Angle`, or for `Axes = "
                            "cylindrical`.");
    if (dim == 2 && is_cylindrical && section.is_set("Axis"))
      section.fail("Axis", "two dimensions have none; directions are those from `Centre`.");
    condition.axes = LocalAxes<dim>(section);
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
      if (condition.turn->angle.depends_on_position())
        section.fail("Angle", "allowed is a function of t.");
    }
    if (!turns || section.is_set("Function"))
      condition.function.emplace(section, "Function", type == Type::pressure ? 1 : dim,
                                 prescribes(type));
    return condition;
  }

  template <int dim>
  void MechanicalCondition<dim>::read_times(const Section &section)
  {
    if (!section.get("Start").empty() && section.get_double("Start") > 0.)
      start = section.get_double("Start");
    if (!section.get("End").empty())
      end = section.get_double("End");
    if (!(start < end) || !(end > 0.))
      section.fail("End", "it acts at no time; allowed is a time after `Start`.");
  }

  template <int dim>
  double MechanicalCondition<dim>::Turn::displacement(const Point<dim> &position,
                                                      const unsigned int component,
                                                      const double time,
                                                      const std::optional<double> since) const
  {
    using namespace Physics::Transformations::Rotations;
    if (times_of_rotation != std::pair{time, since})
    {
      double by = angle.value(Point<dim>(), time);
      if (since)
        by -= angle.value(Point<dim>(), *since);
      if constexpr (dim == 2)
        rotation = rotation_matrix_2d(by);
      else
        rotation = rotation_matrix_3d(axis, by);
      times_of_rotation = {time, since};
    }
    const Tensor<1, dim> arm = position - centre;
    return rotation[component] * arm - arm[component];
  }

  template <int dim>
  double MechanicalCondition<dim>::displacement(const Point<dim> &initial,
                                                const unsigned int component,
                                                const double time) const
  {
    const double shift = function ? function->value(initial, time, component) : 0.;
    return turn ? turn->displacement(initial, component, time) + shift : shift;
  }

  template <int dim>
  double MechanicalCondition<dim>::prescribed_velocity(const Point<dim> &initial,
                                                       const double *const position,
                                                       const unsigned int component,
                                                       const double time, const double time_step,
                                                       const Tensor<1, dim> *const direction) const
  {
    if (type == Type::clamp)
      return 0.;
    if (type == Type::velocity)
      return function->value(initial, time + 0.5 * time_step, component);
    if (std::isfinite(start))
    {
      double change = 0;
      if (function)
        change += function->value(initial, time + time_step, component) -
                  function->value(initial, time, component);
      if (turn) // from where the node is
        change += turn->displacement(point_of<dim>(position), component, time + time_step, time);
      return change / time_step;
    }
    if (direction != nullptr)
    {
      double way = displacement(initial, component, time + time_step);
      for (unsigned int d = 0; d < dim; ++d)
        way -= (*direction)[d] * (position[d] - initial[d]);
      return way / time_step;
    }
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

  template <int dim>
  Tensor<1, dim> MechanicalCondition<dim>::load_at(const Point<dim> &initial,
                                                   const double time) const
  {
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = function->value(initial, time, d);
    return axes.are_local() ? result * axes.at(initial) : result;
  }

  template struct MechanicalCondition<2>;
  template struct MechanicalCondition<3>;
} // namespace tombolo
