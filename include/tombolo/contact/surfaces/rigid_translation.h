// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/clock.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>

#include <optional>

namespace tombolo
{
  class Records;

  /**
   * How far a rigid body has moved: by functions of time, or as a mass that forces move, with the
   * same central differences as the bodies (eqs 22-24): its velocity is that at t_{n-1/2}.
   *
   * A mass moves along its free directions only; a guide balances the forces across them. All ranks
   * hold the same.
   */
  template <int dim>
  class RigidTranslation
  {
  public:
    /** Of a body that stays. */
    RigidTranslation() = default;

    /** "Displacement", "Mass", "Force", "Initial velocity", "Directions". */
    explicit RigidTranslation(const Entries &e);

    /** [L]. Of a mass it is that at t_n or t_{n-1}, the nearer of the two. */
    dealii::Tensor<1, dim> displacement(double time) const;

    bool has_mass() const
    {
      return free.has_value();
    }

    /** Zero where the body moves by functions of time [M]. */
    double mass() const
    {
      return free ? free->mass : 0.;
    }

    /** Whether a mass can move along an axis of coordinates, if only a little. */
    bool moves_along(const unsigned int axis) const
    {
      return free && free->free_directions[axis].norm() > 1e-12;
    }

    /** The acceleration at t_n by the given force and @p reaction, that of the bodies at t_n, on
     * the mass; the size of the coming step must be set. */
    void accelerate(const Clock &clock, const dealii::Tensor<1, dim> &reaction);

    /** How far the mass will move in the coming step without any force of bodies [L]. */
    dealii::Tensor<1, dim> free_motion(const Clock &clock) const
    {
      return clock.next_step * free->velocity + motion_by(given_impulse(clock), clock.next_step);
    }

    /** How far an @p impulse moves the mass in a step of size @p time_step [L]. */
    dealii::Tensor<1, dim> motion_by(const dealii::Tensor<1, dim> &impulse,
                                     const double time_step) const
    {
      return time_step * (free->free_directions * impulse) / free->mass;
    }

    /** The mass from t_n to t_{n+1}. */
    void advance(const Clock &clock)
    {
      free->velocity = free->next_velocity;
      free->previous_time = clock.time;
      free->time = clock.time + clock.next_step;
      free->previous_displacement = free->displacement;
      free->displacement += clock.next_step * free->velocity;
    }

    /** v_{n-1/2} of the mass [L/T]. */
    const dealii::Tensor<1, dim> &velocity() const
    {
      return free->velocity;
    }

    /** ½ m v_{n-1/2} · v_{n+1/2} after accelerate() [M L^2/T^2]. */
    double kinetic_energy() const
    {
      return free ? free->kinetic_energy : 0.;
    }

    /** That the given force has done on the mass since the start. */
    double work_of_force() const
    {
      return free ? free->work_of_force : 0.;
    }

    /** Lists what is kept of a mass between two steps. */
    void list(Records &records);

  private:
    struct Mass
    {
      double mass;
      std::optional<Expression<dim>> force;
      dealii::Tensor<2, dim> free_directions; ///< the projection onto them

      double time = 0, previous_time = 0; ///< t_n, t_{n-1}
      dealii::Tensor<1, dim> displacement, previous_displacement;
      dealii::Tensor<1, dim> velocity, next_velocity;
      dealii::Tensor<1, dim> previous_impulse; ///< Δt_{n-1} times the given force
      double kinetic_energy = 0;
      double work_of_force = 0;
    };
    dealii::Tensor<1, dim> given_impulse(const Clock &clock) const
    {
      dealii::Tensor<1, dim> impulse;
      if (free->force)
        for (unsigned int d = 0; d < dim; ++d)
          impulse[d] =
              clock.velocity_step() * free->force->value(dealii::Point<dim>(), clock.time, d);
      return impulse;
    }
    static dealii::Tensor<2, dim> read_directions(const Section &section);
    static Mass read_mass(const Section &section);

    std::optional<Expression<dim>> function;
    std::optional<Mass> free; ///< of a body that forces move
  };
} // namespace tombolo
