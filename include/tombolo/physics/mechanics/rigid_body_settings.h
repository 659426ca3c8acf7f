// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>

#include <optional>

namespace tombolo
{
  /** How a rigid body turns. */
  enum class RigidRotation
  {
    by_angle,   ///< as a function of time says, about an axis
    about_axis, ///< as moments say, about an axis that keeps its direction
    free        ///< as moments say
  };

  /**
   * What the section "Part: NAME/rigid" says of the motion of a body: the displacement of its
   * reference point and its angle as functions of time, or which of them forces move, given forces
   * and the motion at the start. In the words of the motion of rigid tools (RigidMotion). Vectors
   * have three components; in two dimensions rotation is about z.
   */
  template <int dim>
  struct RigidBodySettings
  {
    using Vector = dealii::Tensor<1, 3>;

    /** Throws InputError. */
    explicit RigidBodySettings(const Entries &e);

    /** Whether forces move the reference point along an axis of coordinates. */
    bool is_free(const unsigned int component) const
    {
      return displacement && component < dim && displacement->is_free(component);
    }

    /** Whether forces move the body in any way. */
    bool moves_by_forces() const;

    /** u(t) of the reference point, zero in free components [L]. */
    Vector displacement_at(double time) const;
    double angle_at(double time) const;  ///< [rad]
    Vector force_at(double time) const;  ///< given, at the reference point [M L/T^2]
    Vector moment_at(double time) const; ///< given, about the reference point [M L^2/T^2]

    std::optional<Vector> origin; ///< none: the centre of mass
    RigidRotation rotation;
    Vector axis; ///< of by_angle and about_axis; of length one
    std::optional<Vector> initial_velocity, initial_spin;

  private:
    void read_initial_motion(const Entries &e);

    std::optional<Expression<dim>> displacement, angle, force, moment;
  };
} // namespace tombolo
