// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/read_vector.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

#include <cmath>
#include <optional>

namespace tombolo
{
  /** The motion of a rigid tool: it turns about an axis through its origin (in two dimensions about
   * the origin) by an angle that is a function of time, and its origin moves by a RigidTranslation.
   */
  template <int dim>
  class RigidMotion
  {
  public:
    RigidMotion() = default;

    /** "Origin", "Angle", and the entries of RigidTranslation. Turns about @p axis, a unit vector,
     * which is not used in two dimensions. */
    RigidMotion(const Entries &e, const dealii::Tensor<1, dim> &axis) : axis(axis)
    {
      initial_origin = e.read(
          "Origin", mandatory, "L",
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

    /** [L] */
    dealii::Tensor<1, dim> origin(const double time) const
    {
      return initial_origin + rigid_translation.displacement(time);
    }

    /** [rad] */
    double angle(const double time) const
    {
      return rotation ? rotation->value(dealii::Point<dim>(), time) : 0.;
    }

    RigidTranslation<dim> &translation()
    {
      return rigid_translation;
    }

    /** @p vector turned about the axis. */
    dealii::Tensor<1, dim> turned(const dealii::Tensor<1, dim> &vector, const double angle) const
    {
      if (angle == 0.)
        return vector;
      const double cosine = std::cos(angle), sine = std::sin(angle);
      if constexpr (dim == 2)
        return dealii::Tensor<1, dim>(
            {cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1]});
      else
      {
        const dealii::Tensor<1, dim> along = (vector * axis) * axis, across = vector - along;
        return along + cosine * across + sine * dealii::cross_product_3d(axis, across);
      }
    }

    /** How far the point of the body that is at @p point moves from time @p from to time @p to [L].
     * The turn is the one around the middle of the time, so that a surface that turns about its own
     * axis moves along itself, and not towards what it touches. */
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, const double from,
                                  const double to) const
    {
      const dealii::Tensor<1, dim> arm = point - origin(to);
      const double half = 0.5 * (angle(to) - angle(from));
      return origin(to) - origin(from) + turned(arm, half) - turned(arm, -half);
    }

  private:
    dealii::Tensor<1, dim> axis;
    dealii::Tensor<1, dim> initial_origin;
    RigidTranslation<dim> rigid_translation;
    std::optional<Expression<dim>> rotation;
  };

  /** A rigid surface that moves as a whole by a RigidMotion: what tools of any shape share. */
  template <int dim>
  class RigidTool : public ContactSurface<dim>
  {
  public:
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, const double from,
                                  const double to) const override
    {
      return rigid_motion.motion(point, from, to);
    }

    dealii::Tensor<1, dim> reference_point(const double time) const override
    {
      return rigid_motion.origin(time);
    }

    RigidTranslation<dim> &translation() override
    {
      return rigid_motion.translation();
    }

  protected:
    RigidMotion<dim> rigid_motion;
  };
} // namespace tombolo
