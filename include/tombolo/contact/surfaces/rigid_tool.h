// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

#include <cmath>
#include <limits>
#include <optional>

namespace tombolo
{
  /** A rigid surface that moves as a whole, what tools of any shape share: it turns about an axis
   * through its origin (in two dimensions about the origin) by an angle that is a function of time,
   * and its origin moves by a RigidTranslation. */
  template <int dim>
  class RigidTool : public ContactSurface<dim>
  {
  public:
    /** The turn is the one around the middle of the time, so that a surface that turns about its
     * own axis moves along itself, and not towards what it touches. */
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, const double from,
                                  const double to) const override
    {
      // All nodes of a step have the same times; the motion of a mass also depends on its state.
      if (from != last.from || to != last.to || rigid_translation.has_mass())
        last = {from, to, origin(to), origin(to) - origin(from), 0.5 * (angle(to) - angle(from))};
      const dealii::Tensor<1, dim> arm = point - last.origin;
      return last.translation + turned(arm, last.half) - turned(arm, -last.half);
    }

    dealii::Tensor<1, dim> reference_point(const double time) const override
    {
      return origin(time);
    }

    RigidTranslation<dim> &translation() override
    {
      return rigid_translation;
    }

  protected:
    /** "Origin", "Angle", and the entries of RigidTranslation. Turns about @p through_origin, a
     * unit vector, which is not used in two dimensions. */
    void read_motion(const Entries &e, const dealii::Tensor<1, dim> &through_origin)
    {
      turning_axis = through_origin;
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
      e.refuse(rotation && rotation->depends_on_position(), "Angle",
               "allowed is a function of t alone.");
    }

    /** [L] */
    dealii::Tensor<1, dim> origin(const double time) const
    {
      if (time != time_of_origin || rigid_translation.has_mass())
        last_origin = initial_origin + rigid_translation.displacement(time);
      time_of_origin = time;
      return last_origin;
    }

    /** [rad] */
    double angle(const double time) const
    {
      return rotation ? rotation->value(dealii::Point<dim>(), time) : 0.;
    }

    /** Whether `Angle` is a constant other than zero, which turns no body of revolution. */
    bool has_constant_angle() const
    {
      return rotation && !rotation->depends_on_time() && angle(0.) != 0.;
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
        const dealii::Tensor<1, dim> along = (vector * turning_axis) * turning_axis,
                                     across = vector - along;
        return along + cosine * across + sine * dealii::cross_product_3d(turning_axis, across);
      }
    }

  private:
    /** Between two times. */
    struct Motion
    {
      double from = std::numeric_limits<double>::quiet_NaN(), to = from;
      dealii::Tensor<1, dim> origin;      ///< at the end
      dealii::Tensor<1, dim> translation; ///< of the origin
      double half = 0;                    ///< of the turn [rad]
    };
    mutable Motion last;
    mutable double time_of_origin = std::numeric_limits<double>::quiet_NaN();
    mutable dealii::Tensor<1, dim> last_origin;

    dealii::Tensor<1, dim> turning_axis;
    dealii::Tensor<1, dim> initial_origin;
    RigidTranslation<dim> rigid_translation;
    std::optional<Expression<dim>> rotation;
  };
} // namespace tombolo
