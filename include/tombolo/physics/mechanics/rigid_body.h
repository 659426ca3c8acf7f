// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/base/clock.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/moment.h>
#include <tombolo/physics/mechanics/rigid_rotation.h>

#include <array>
#include <optional>
#include <string>

namespace tombolo
{
  /** Position, motion and drive of a rigid body; the same on all ranks. Impulses are those of the
   * reactions at prescribed components, until t_{n+1/2} and with
   * moments about the reference point; the work is that of the drive and of given forces. In two
   * dimensions rotations, spins and moments are about z. */
  struct RigidBodyBalance : ImpulseBalance
  {
    using Vector = std::array<double, 3>;

    Vector position{};          ///< of the reference point at t_n [L]
    Vector rotation{};          ///< the rotation vector from the start to t_n [rad]
    Vector velocity{};          ///< of the reference point at t_{n-1/2} [L/T]
    Vector spin{};              ///< the angular velocity at t_{n-1/2} [rad/T]
    Vector momentum{};          ///< at t_{n-1/2} [M L/T]
    Vector angular_momentum{};  ///< about the centre of mass, likewise [M L^2/T]
    double kinetic_energy = 0;  ///< at t_n, of translation and rotation [M L^2/T^2]
    double rotation_energy = 0; ///< the part of it that is of rotation about the centre of mass
  };

  /** How a rigid body turns. */
  enum class RigidRotation
  {
    by_angle,   ///< by a function of time, about an axis
    about_axis, ///< by moments, about an axis that keeps its direction
    free        ///< by moments
  };

  /**
   * The section "Part: NAME/rigid" of the motion of a body: the displacement of its
   * reference point and its angle as functions of time, or which of them forces move, given forces
   * and the motion at the start. With the entries of the motion of rigid tools (RigidTool). Vectors
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
    bool moves_by_forces() const
    {
      bool result = rotation != RigidRotation::by_angle;
      for (unsigned int d = 0; d < dim; ++d)
        result = result || is_free(d);
      return result;
    }

    /** u(t) of the reference point, zero in free components [L]. */
    Vector displacement_at(const double time) const
    {
      return vector_at(displacement, time, dim);
    }
    double angle_at(const double time) const ///< [rad]
    {
      return angle ? angle->value(dealii::Point<dim>(), time) : 0.;
    }
    Vector force_at(const double time) const ///< given, at the reference point [M L/T^2]
    {
      return vector_at(force, time, dim);
    }
    Vector moment_at(const double time) const ///< given, about the reference point [M L^2/T^2]
    {
      return vector_at(moment, time, n_rotations);
    }

    std::optional<Vector> origin; ///< none: the centre of mass
    RigidRotation rotation;
    Vector axis; ///< of by_angle and about_axis; of length one
    std::optional<Vector> initial_velocity, initial_spin;

  private:
    /** Components of an angle, a spin or a moment. */
    static constexpr unsigned int n_rotations = dim == 3 ? 3 : 1;

    void read_initial_motion(const Entries &e);

    /** Zero where there is no function; a single component is that along z. */
    static Vector vector_at(const std::optional<Expression<dim>> &function, const double time,
                            const unsigned int n_components)
    {
      Vector result;
      for (unsigned int d = 0; d < n_components && function; ++d)
        result[n_components == 1 ? 2 : d] = function->value(dealii::Point<dim>(), time, d);
      return result;
    }

    std::optional<Expression<dim>> displacement, angle, force, moment;
  };

  class Records;
  class ImpulseAccount;

  /** The inertia of a rigid body, in its initial position. Second moments are about the centre. */
  struct RigidInertia
  {
    double mass = 0;                   ///< [M]
    dealii::Tensor<1, 3> centre;       ///< of mass [L]
    dealii::Tensor<2, 3> second;       ///< of the cells, and of nodes shared with others [M L^2]
    dealii::Tensor<2, 3> nodal_second; ///< of the masses of nodes [M L^2]
  };

  /** A force and a moment, or their impulses. */
  struct Wrench
  {
    dealii::Tensor<1, 3> force, moment;
  };

  /**
   * A rigid body that moves from t_n to t_{n+1} by central differences (doc/rigid_bodies.md): its
   * momentum by the resultant of all forces at t_n, its angular momentum by their moment about the
   * centre of mass, and its rotation by rigid_rotation::find_rotation(). The prescribed motion of
   * its reference point p and the prescribed rotation are met exactly at t_{n+1}, by a force at p
   * and a moment, the reaction: that of t_n, as all forces. The same on all ranks.
   */
  template <int dim>
  class RigidBody
  {
  public:
    using Vector = dealii::Tensor<1, 3>;
    using Matrix = dealii::Tensor<2, 3>;

    /** A body at rest. */
    RigidBody(const std::string &name, RigidBodySettings<dim> settings,
              const RigidInertia &inertia);

    /** Sets the initial motion of the body: the free components of @p velocity of the centre and of
     * @p spin, unless the settings have them, and the prescribed rates over the short @p interval
     * after the start. */
    void start(const Vector &velocity, const Vector &spin, const double interval)
    {
      set_motion(velocity, spin, interval, false);
    }

    /** The motion of the coming step, whose size must be set, by the resultant @p force of all
     * forces on its nodes at t_n, and their @p moment about the centre of mass. Throws RunError,
     * on all ranks alike, where the body turns too far in a step. */
    void find_motion(const Clock &clock, const Vector &force, const Vector &moment);

    /** How far points of the body move: x - X or, in a step, x_{n+1} - x_n [L]. */
    struct Placement
    {
      Vector shift, centre_at_start;
      Matrix turn; ///< a rotation less another one

      Vector of(const Vector &initial) const
      {
        return shift + turn * (initial - centre_at_start);
      }
    };

    /** From the start to t_n. */
    Placement placement() const;

    /** Of the coming step, after find_motion(), with all digits of small motions. */
    Placement motion_of_step(const Clock &clock) const
    {
      Placement result;
      result.centre_at_start = initial.centre;
      result.shift = clock.next_step / initial.mass * next.momentum;
      result.turn = orientation(present) * rigid_rotation::exponential_less_one(next.increment);
      return result;
    }

    /** The velocity at the start of a point of the body that is at @p position. */
    Vector velocity_at_start(const Vector &position) const
    {
      return present.momentum / initial.mass +
             dealii::cross_product_3d(present.spin, position - present.centre);
    }

    /** Sets the inertia from t_n on. */
    void set_inertia(const RigidInertia &inertia);

    /** Sets the momentum at t_n to the @p momentum and the @p angular_momentum of its nodes about
     * its centre of mass, with the part of the body beyond them, as far as its motion is not
     * prescribed. Returns the motion of points of the body from t_n back to t_{n-1} then. Throws
     * RunError, on all ranks alike, where the body turns too far in a step. */
    Placement set_momentum(const Clock &clock, const Vector &momentum,
                           const Vector &angular_momentum);

    /** kinetic_energy_beyond_nodes() in the last step, @p interval long. */
    double energy_beyond_nodes_before(const double interval) const
    {
      const Matrix before =
          1. / interval * rigid_rotation::exponential_less_one(-1. * present.increment);
      return 0.5 * trace(before * (initial.second - initial.nodal_second) * transpose(before));
    }

    /** Works and impulses of the step, after find_motion(). Adds the external impulses of the
     * nodes, corrected by the inertia of the body beyond that of the masses of nodes, to @p
     * impulses; on one rank only. */
    void complete_step(const Clock &clock, ImpulseAccount *impulses);

    /** From t_n to t_{n+1}. */
    void advance()
    {
      present = next;
    }

    /** The kinetic energy of the body beyond that of the masses of its nodes at t_n, which are
     * farther out than its cells; after complete_step() [M L^2/T^2]. */
    double kinetic_energy_beyond_nodes() const
    {
      return beyond_nodes_energy;
    }

    /** Of reactions and given forces since the start [M L^2/T^2]. */
    double external_work() const
    {
      return drive_work + force_work;
    }

    RigidBodyBalance balance() const;

    /** The centre of mass at t_n [L]. */
    const Vector &centre() const
    {
      return present.centre;
    }
    const std::string &name() const
    {
      return body_name;
    }
    const RigidInertia &inertia() const
    {
      return initial;
    }
    const RigidBodySettings<dim> &motion() const
    {
      return settings;
    }

    /** Lists the state from step to step. */
    void list(Records &records);

    /** Starts from the position of the body of this name at the end of another run, which was read,
     * with its velocities there; where they are prescribed, with the rates over the short @p
     * interval after the start. Displacement and angle that are prescribed count from there. */
    void continue_motion(const double interval)
    {
      reference_at_start = present.centre + arm(present);
      angle_at_start = present.angle;
      set_motion(present.momentum / initial.mass, present.spin, interval, true);
      next = present;
    }

  private:
    /** The state from step to step. Velocities are those of t_{n-1/2}. */
    struct State
    {
      Vector centre;
      rigid_rotation::Quaternion turn{{1., 0., 0., 0.}}; ///< from the start
      double angle = 0;                                  ///< about the axis, where there is one
      Vector momentum;                                   ///< [M L/T]
      Vector angular_momentum;                           ///< about the centre of mass [M L^2/T]
      Vector increment;          ///< of the last rotation, in the body's own axes [rad]
      Vector spin;               ///< [rad/T]
      Vector reference_velocity; ///< of the reference point
      Vector beyond_nodes;       ///< angular momentum, less that of the masses of nodes [M L^2/T]
    };

    /** Sets the initial velocities; @p velocity (of the centre) and @p spin are those of components
     * that nothing else prescribes. */
    void set_motion(const Vector &velocity, const Vector &spin, double interval, bool is_continued);
    Matrix orientation(const State &state) const
    {
      return settings.rotation == RigidRotation::free
                 ? rigid_rotation::matrix_of(state.turn)
                 : rigid_rotation::exponential(state.angle * settings.axis);
    }
    /** Of the reference point from the centre of mass. */
    Vector arm(const State &state) const
    {
      return orientation(state) * reference_arm;
    }

    /** Computes the state at t_{n+1} with the @p momentum and the @p angular_momentum by the
     * forces; returns whether there is one. */
    bool move(const Clock &clock, const Vector &momentum, const Vector &angular_momentum,
              State &end) const;
    /** By which a force at the reference point at t_n moves it in the step; identity and zero in
     * components that are not prescribed. */
    Matrix response(const Clock &clock) const;
    double kinetic_energy_of_rotation(const Clock &clock, const Matrix &second_moment) const;

    std::string body_name;
    RigidBodySettings<dim> settings;
    RigidInertia initial;
    Matrix body_inertia, inertia_beyond_nodes; ///< tensors of inertia, in the body's own axes
    Vector reference_position;                 ///< of the reference point, at the start
    Vector reference_arm;                      ///< of it from the centre of mass
    Vector reference_at_start;                 ///< where prescribed displacements begin
    double angle_at_start = 0;                 ///< where a prescribed angle begins
    State present, next;
    Wrench reaction, given;                   ///< at t_n
    Wrench previous_reaction, previous_given; ///< Δt_{n-1} times those at t_{n-1}
    Wrench impulse;                           ///< of reactions, since the start
    double drive_work = 0, force_work = 0;    ///< of reactions and given forces
    double beyond_nodes_energy = 0;
    double kinetic_energy = 0, rotation_energy = 0;
  };
} // namespace tombolo
