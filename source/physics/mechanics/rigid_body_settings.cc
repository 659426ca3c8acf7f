// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_body.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/read_vector.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    constexpr double rounding = 1e-12;

    template <int dim>
    Tensor<1, 3> read_spatial_vector(const Section &section, const std::string &entry)
    {
      Tensor<1, 3> result;
      const Tensor<1, dim> components = read_vector<dim>(section, entry);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = components[d];
      return result;
    }

    /** A function of t alone; none where the entry is empty. */
    template <int dim>
    std::optional<Expression<dim>>
    function_of_time(const Entries &e, const std::string &entry, const std::string &unit,
                     const std::string &documentation, const unsigned int n_components,
                     const bool allow_free = false)
    {
      auto function =
          e.optional<Expression<dim>>(entry, unit, documentation, n_components, allow_free);
      e.refuse(function && function->depends_on_position(), entry,
               n_components == 1 ? "allowed is a function of t alone."
                                 : "allowed are functions of t alone.");
      return function;
    }

    constexpr const char *zero_at_start =
        "allowed is a function that is zero at t = 0, since the mesh shows the body as it is then.";
  } // namespace

  template <int dim>
  RigidBodySettings<dim>::RigidBodySettings(const Entries &e)
  {
    if (!e.text("Origin", "", "L",
                "The reference point at t = 0, as numbers separated by commas: `Displacement` and "
                "`Initial velocity` are those of this point of the body, `Force` acts on it, and "
                "the body turns about it. The centre of mass if empty.")
             .empty())
      origin = read_spatial_vector<dim>(e.section(), "Origin");
    displacement =
        function_of_time<dim>(e, "Displacement", "L",
                              "How far the reference point has moved at time t: components "
                              "separated by `;`, functions of t, zero at t = 0. The word `free` "
                              "leaves a component to the forces. Empty: the point is at rest.",
                              dim, true);
    e.refuse(displacement_at(0.).norm() > rounding, "Displacement", zero_at_start);
    // Read below, where the body turns about it.
    if (dim == 3 && e.declares())
      e.text(
          "Axis", "0, 0, 1", "",
          "The direction of the axis of rotation through the reference point, as numbers separated "
          "by commas; not where `Rotation` is `free`.");
    const std::string how = e.choice(
        "Rotation", "by angle", dim == 3 ? "by angle|about the axis|free" : "by angle|free",
        dim == 3 ? "How the body turns: as `Angle` says, as the moments on it say about an axis "
                   "that keeps its direction, or `free`, as the moments say."
                 : "How the body turns: as `Angle` says, or `free`, as the moments on it say.");
    // A plane body that turns freely turns about z.
    rotation = how == "by angle"           ? RigidRotation::by_angle
               : how == "free" && dim == 3 ? RigidRotation::free
                                           : RigidRotation::about_axis;
    const bool is_by_angle = rotation == RigidRotation::by_angle;
    e.refuse(!is_by_angle && e.is_set("Angle"), "Angle",
             "the rotation is given twice: by this function, and by the moments on the body as "
             "`Rotation` says. Remove one of them.");
    if (e.when(is_by_angle))
      angle = function_of_time<dim>(
          e, "Angle", "rad",
          "The angle by which the body has turned about the axis (in two dimensions about the "
          "reference point), a function of t such as `2*pi*50*t`; it does not turn if empty. Only "
          "with `Rotation = by angle`.",
          1);
    e.refuse(std::abs(angle_at(0.)) > rounding, "Angle", zero_at_start);
    axis = Vector({0., 0., 1.});
    if constexpr (dim == 3)
      if (angle || rotation == RigidRotation::about_axis)
        axis = read_direction<3>(e.section(), "Axis");
    force = function_of_time<dim>(
        e, "Force", "M L/T^2",
        "A force on the reference point, beside those of contacts and conditions: components "
        "separated by `;`, functions of t; none if empty.",
        dim);
    moment = function_of_time<dim>(
        e, "Moment", "M L^2/T^2",
        dim == 3 ? "A moment about the reference point: components separated by `;`, functions of "
                   "t; none if empty."
                 : "A moment about the reference point, a function of t; none if empty.",
        n_rotations);
    e.refuse(force && !moves_by_forces(), "Force",
             "the motion of the body is given by `Displacement` and `Angle`, so that no force "
             "changes it; leave a component `free`.");
    e.refuse(moment && is_by_angle, "Moment",
             "the body turns as `Angle` says, so that no moment changes its rotation; allowed is "
             "another `Rotation`.");
    read_initial_motion(e);
  }

  template <int dim>
  void RigidBodySettings<dim>::read_initial_motion(const Entries &e)
  {
    if (!e.text("Initial velocity", "", "L/T",
                "Of the reference point in the components that are free, as numbers separated by "
                "commas. If empty it follows from initial conditions at the nodes.")
             .empty())
    {
      initial_velocity = read_spatial_vector<dim>(e.section(), "Initial velocity");
      for (unsigned int d = 0; d < dim; ++d)
        e.refuse(!is_free(d) && (*initial_velocity)[d] != 0., "Initial velocity",
                 std::string("the motion along ") + "xyz"[d] +
                     " is given twice: `Displacement` gives it already; allowed is 0 there, or the "
                     "word `free` in `Displacement`.");
    }
    if (e.text("Initial spin", "", "rad/T",
               dim == 3 ? "Of a body that turns by moments: the vector of its angular velocity, "
                          "as numbers separated by commas. If empty it follows from initial "
                          "conditions at the nodes."
                        : "Of a body that turns by moments: its angular velocity. If empty it "
                          "follows from initial conditions at the nodes.")
            .empty())
      return;
    const Section &section = e.section();
    if (rotation == RigidRotation::by_angle)
      section.fail("Initial spin", "the rotation is given twice: `Angle` gives it already; allowed "
                                   "is another `Rotation`.");
    if constexpr (dim == 3)
    {
      initial_spin = read_vector<3>(section, "Initial spin");
      const Vector across = *initial_spin - (*initial_spin * axis) * axis;
      if (rotation == RigidRotation::about_axis && across.norm() > 1e-9 * initial_spin->norm())
        section.fail("Initial spin", "the body cannot turn so: allowed is a spin along `Axis`.");
    }
    else
      initial_spin = section.get_double("Initial spin") * axis;
  }

  template struct RigidBodySettings<2>;
  template struct RigidBodySettings<3>;
} // namespace tombolo
