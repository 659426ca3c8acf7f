// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surfaces/rigid_tool.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/read_vector.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  RigidMotion<dim>::RigidMotion(const Entries &e, const Tensor<1, dim> &axis) : axis(axis)
  {
    initial_origin =
        e.read("Origin", mandatory, "L",
               "The origin of the tool's own coordinates at t = 0, as numbers separated by commas.",
               &read_vector<dim>);
    rigid_translation = RigidTranslation<dim>(e);
    rotation = e.optional<Expression<dim>>(
        "Angle", "rad",
        "The angle by which the tool has turned about its axis (in two dimensions about its "
        "origin), a function of t such as `2*pi*50*t`; it does not turn if empty.",
        1);
    e.refuse(rotation && rotation->depends_on_place(), "Angle",
             "allowed is a function of t alone.");
  }

  template <int dim>
  Tensor<1, dim> RigidMotion<dim>::origin(const double time) const
  {
    return initial_origin + rigid_translation.displacement(time);
  }

  template <int dim>
  double RigidMotion<dim>::angle(const double time) const
  {
    return rotation ? rotation->value(Point<dim>(), time) : 0.;
  }

  template <int dim>
  RigidTranslation<dim> &RigidMotion<dim>::translation()
  {
    return rigid_translation;
  }

  template <int dim>
  Tensor<1, dim> RigidMotion<dim>::turned(const Tensor<1, dim> &vector, const double angle) const
  {
    if (angle == 0.)
      return vector;
    const double cosine = std::cos(angle), sine = std::sin(angle);
    if constexpr (dim == 2)
      return Tensor<1, dim>(
          {cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1]});
    else
    {
      const Tensor<1, dim> along = (vector * axis) * axis, across = vector - along;
      return along + cosine * across + sine * cross_product_3d(axis, across);
    }
  }

  template <int dim>
  Tensor<1, dim> RigidMotion<dim>::motion(const Tensor<1, dim> &point, const double from,
                                          const double to) const
  {
    const Tensor<1, dim> arm = point - origin(to);
    const double half = 0.5 * (angle(to) - angle(from));
    return origin(to) - origin(from) + turned(arm, half) - turned(arm, -half);
  }

  template class RigidMotion<2>;
  template class RigidMotion<3>;
} // namespace tombolo
