// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/boundary/mechanical_condition.h>

#include <tombolo/base/input/entries.h>

#include <deal.II/base/exceptions.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using Type = MechanicalConditionType;

    Type type_of(const std::string &name)
    {
      if (name == "traction")
        return Type::traction;
      if (name == "pressure")
        return Type::pressure;
      if (name == "body force")
        return Type::body_force;
      if (name == "gravity")
        return Type::gravity;
      if (name == "velocity")
        return Type::velocity;
      if (name == "displacement")
        return Type::displacement;
      Assert(name == "clamp", ExcInternalError());
      return Type::clamp;
    }
  } // namespace

  bool prescribes_motion(const MechanicalConditionType type)
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
  }

  template <int dim>
  MechanicalCondition<dim> MechanicalCondition<dim>::read(const Section &section)
  {
    const Type type = type_of(section.get("Type"));
    MechanicalCondition condition{
        section.name(), type, Place<dim>(section, is_on_volume(type)), {}};
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
    condition.function.emplace(section, "Function", type == Type::pressure ? 1 : dim,
                               prescribes_motion(type));
    return condition;
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
    return (initial[component] + function->value(initial, time + time_step, component) -
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
    return (function->value(initial, time + interval, component) -
            function->value(initial, time, component)) /
           interval;
  }

  template struct MechanicalCondition<2>;
  template struct MechanicalCondition<3>;
} // namespace tombolo
