// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/boundary/region.h>

#include <optional>
#include <string>

namespace tombolo
{
  enum class MechanicalConditionType
  {
    traction,   ///< force per current area, in a given direction
    pressure,   ///< force per current area against the outward normal of the current face
    body_force, ///< force per mass
    gravity,    ///< the same, of everything unless a region is given
    velocity,
    displacement,
    clamp
  };

  /** Whether conditions of this type prescribe components of the motion. */
  bool prescribes_motion(MechanicalConditionType type);

  /** Whether they act on faces of the boundary. */
  bool is_on_faces(MechanicalConditionType type);

  /** What one section "Condition: NAME" of mechanics says. */
  template <int dim>
  struct MechanicalCondition
  {
    std::string name;
    MechanicalConditionType type;
    Place<dim> place;
    /** Of place and time: dim components, one of a pressure, none of a clamp. */
    std::optional<Expression<dim>> function;

    /** Declares the section of one condition; the handler is in it. */
    static void declare_parameters(const Entries &e);

    /** Throws InputError. */
    static MechanicalCondition read(const Section &section);

    /** The prescribed velocity of the interval from @p time to @p time + @p time_step of a node
     * that is at @p position [L/T]; that of a displacement reaches the prescribed place at its end.
     * Throws RunError where the function has no finite value. */
    double prescribed_velocity(const dealii::Point<dim> &initial, const double *position,
                               unsigned int component, double time, double time_step) const;

    /** The prescribed velocity at @p time; that of a displacement is its rate over the short @p
     * interval after it. Throws likewise. */
    double initial_velocity(const dealii::Point<dim> &initial, const double *position,
                            unsigned int component, double time, double interval) const;
  };
} // namespace tombolo
