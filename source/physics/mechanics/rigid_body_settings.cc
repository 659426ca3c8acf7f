// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_body_settings.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/contact/read_vector.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr double rounding = 1e-12;

    /** Of an angle, a spin or a moment. */
    template <int dim>
    constexpr unsigned int n_rotations = dim == 3 ? 3 : 1;

    template <int dim>
    Tensor<1, 3> read_spatial_vector(const Section &section, const std::string &entry)
    {
      Tensor<1, 3> result;
      const Tensor<1, dim> components = read_vector<dim>(section, entry);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = components[d];
      return result;
    }

    /** Reads a function of t alone; none where the entry is empty. */
    template <int dim>
    void read_function(const Section &section, const std::string &entry,
                       const unsigned int n_components, const bool allow_free,
                       std::optional<Expression<dim>> &function)
    {
      if (section.get(entry).empty())
        return;
      function.emplace(section, entry, n_components, allow_free);
      if (function->depends_on_place())
        section.fail(entry, n_components == 1 ? "allowed is a function of t alone."
                                              : "allowed are functions of t alone.");
    }

    constexpr const char *zero_at_start =
        "allowed is a function that is zero at t = 0, since the mesh shows the body as it is then.";
  } // namespace

  template <int dim>
  void RigidBodySettings<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations section(handler);
    section.text("Origin", "", "L",
                 "The reference point at t = 0, as numbers separated by commas: `Displacement` and "
                 "`Initial velocity` are those of this point of the body, `Force` acts on it, and "
                 "the body turns about it. The centre of mass if empty.");
    section.text("Displacement", "", "L",
                 "How far the reference point has moved at time t: components separated by `;`, "
                 "functions of t, zero at t = 0. The word `free` leaves a component to the forces. "
                 "Empty: the point is at rest.");
    if (dim == 3)
      section.text("Axis", "0, 0, 1", "",
                   "The direction of the axis of rotation through the reference point, as numbers "
                   "separated by commas; not where `Rotation` is `free`.");
    section.choice("Rotation", "by angle",
                   dim == 3 ? "by angle|about the axis|free" : "by angle|free",
                   dim == 3 ? "How the body turns: as `Angle` says, as the moments on it say about "
                              "an axis that keeps its direction, or `free`, as the moments say."
                            : "How the body turns: as `Angle` says, or `free`, as the moments on "
                              "it say.");
    section.text("Angle", "", "rad",
                 "The angle by which the body has turned about the axis (in two dimensions about "
                 "the reference point), a function of t such as `2*pi*50*t`; it does not turn if "
                 "empty. Only with `Rotation = by angle`.");
    section.text("Force", "", "M L/T^2",
                 "A force on the reference point, beside those of contacts and conditions: "
                 "components separated by `;`, functions of t; none if empty.");
    section.text("Moment", "", "M L^2/T^2",
                 dim == 3 ? "A moment about the reference point: components separated by `;`, "
                            "functions of t; none if empty."
                          : "A moment about the reference point, a function of t; none if empty.");
    section.text("Initial velocity", "", "L/T",
                 "Of the reference point in the components that are free, as numbers separated by "
                 "commas. If empty it follows from initial conditions at the nodes.");
    section.text("Initial spin", "", "rad/T",
                 dim == 3 ? "Of a body that turns by moments: the vector of its angular velocity, "
                            "as numbers separated by commas. If empty it follows from initial "
                            "conditions at the nodes."
                          : "Of a body that turns by moments: its angular velocity. If empty it "
                            "follows from initial conditions at the nodes.");
  }

  template <int dim>
  RigidBodySettings<dim>::RigidBodySettings(const Section &section)
  {
    if (!section.get("Origin").empty())
      origin = read_spatial_vector<dim>(section, "Origin");
    read_displacement(section);
    read_rotation(section);
    read_forces(section);
    read_initial_motion(section);
  }

  template <int dim>
  void RigidBodySettings<dim>::read_displacement(const Section &section)
  {
    read_function<dim>(section, "Displacement", dim, true, displacement);
    if (displacement_at(0.).norm() > rounding)
      section.fail("Displacement", zero_at_start);
  }

  template <int dim>
  void RigidBodySettings<dim>::read_rotation(const Section &section)
  {
    const std::string how = section.get("Rotation");
    // A plane body that turns freely turns about z.
    rotation = how == "by angle"           ? RigidRotation::by_angle
               : how == "free" && dim == 3 ? RigidRotation::free
                                           : RigidRotation::about_axis;
    if (rotation != RigidRotation::by_angle && section.is_set("Angle"))
      section.fail("Angle", "the rotation is given twice: by this function, and by the moments on "
                            "the body as `Rotation` says. Remove one of them.");
    if (rotation == RigidRotation::by_angle)
      read_function<dim>(section, "Angle", 1, false, angle);
    if (std::abs(angle_at(0.)) > rounding)
      section.fail("Angle", zero_at_start);
    axis = Vector({0., 0., 1.});
    if constexpr (dim == 3)
      if (angle || rotation == RigidRotation::about_axis)
        axis = read_direction<3>(section, "Axis");
  }

  template <int dim>
  void RigidBodySettings<dim>::read_forces(const Section &section)
  {
    read_function<dim>(section, "Force", dim, false, force);
    read_function<dim>(section, "Moment", n_rotations<dim>, false, moment);
    if (force && !moves_by_forces())
      section.fail("Force",
                   "the motion of the body is given by `Displacement` and `Angle`, so that "
                   "no force changes it; leave a component `free`.");
    if (moment && rotation == RigidRotation::by_angle)
      section.fail("Moment", "the body turns as `Angle` says, so that no moment changes its "
                             "rotation; allowed is another `Rotation`.");
  }

  template <int dim>
  void RigidBodySettings<dim>::read_initial_motion(const Section &section)
  {
    if (!section.get("Initial velocity").empty())
    {
      initial_velocity = read_spatial_vector<dim>(section, "Initial velocity");
      for (unsigned int d = 0; d < dim; ++d)
        if (!is_free(d) && (*initial_velocity)[d] != 0.)
          section.fail("Initial velocity",
                       std::string("the motion along ") + "xyz"[d] +
                           " is given twice: `Displacement` gives it already; allowed is 0 there, "
                           "or the word `free` in `Displacement`.");
    }
    if (section.get("Initial spin").empty())
      return;
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

  template <int dim>
  bool RigidBodySettings<dim>::is_free(const unsigned int component) const
  {
    return displacement && component < dim && displacement->is_free(component);
  }

  template <int dim>
  bool RigidBodySettings<dim>::moves_by_forces() const
  {
    bool result = rotation != RigidRotation::by_angle;
    for (unsigned int d = 0; d < dim; ++d)
      result = result || is_free(d);
    return result;
  }

  template <int dim>
  typename RigidBodySettings<dim>::Vector
  RigidBodySettings<dim>::displacement_at(const double time) const
  {
    Vector result;
    for (unsigned int d = 0; d < dim && displacement; ++d)
      result[d] = displacement->value(Point<dim>(), time, d);
    return result;
  }

  template <int dim>
  double RigidBodySettings<dim>::angle_at(const double time) const
  {
    return angle ? angle->value(Point<dim>(), time) : 0.;
  }

  template <int dim>
  typename RigidBodySettings<dim>::Vector RigidBodySettings<dim>::force_at(const double time) const
  {
    Vector result;
    for (unsigned int d = 0; d < dim && force; ++d)
      result[d] = force->value(Point<dim>(), time, d);
    return result;
  }

  template <int dim>
  typename RigidBodySettings<dim>::Vector RigidBodySettings<dim>::moment_at(const double time) const
  {
    Vector result;
    for (unsigned int c = 0; c < n_rotations<dim> && moment; ++c)
      result[dim == 3 ? c : 2] = moment->value(Point<dim>(), time, c);
    return result;
  }

  template struct RigidBodySettings<2>;
  template struct RigidBodySettings<3>;
} // namespace tombolo
