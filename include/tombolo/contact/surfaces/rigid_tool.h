// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

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
    RigidMotion(const Entries &e, const dealii::Tensor<1, dim> &axis);

    dealii::Tensor<1, dim> origin(double time) const; ///< [L]
    double angle(double time) const;                  ///< [rad]

    RigidTranslation<dim> &translation();

    /** @p vector turned about the axis. */
    dealii::Tensor<1, dim> turned(const dealii::Tensor<1, dim> &vector, double angle) const;

    /** How far the point of the body that is at @p point moves from time @p from to time @p to [L].
     * The turn is the one around the middle of the time, so that a surface that turns about its own
     * axis moves along itself, and not towards what it touches. */
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, double from,
                                  double to) const;

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
