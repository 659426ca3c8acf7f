// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_body.h>

#include <tombolo/base/clock.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/formulations/elements/rigid_cells.h>
#include <tombolo/model/impulse_account.h>
#include <tombolo/state/records.h>

#include <cmath>
#include <limits>
#include <utility>

namespace tombolo
{
  namespace
  {
    std::array<double, 3> array_of(const Tensor<1, 3> &vector)
    {
      return {{vector[0], vector[1], vector[2]}};
    }

    [[noreturn]] void fail(const Clock &clock, const std::string &name, const std::string &what)
    {
      throw RunError("At time " + format_number(clock.time) + ", step " +
                     std::to_string(clock.step) + ": the rigid part \"" + name + "\" " + what +
                     "; a smaller time step may help.");
    }

    constexpr const char *turns_too_far = "turns too far in one step";
  } // namespace

  template <int dim>
  RigidBody<dim>::RigidBody(const std::string &name, RigidBodySettings<dim> motion_settings,
                            const RigidInertia &inertia)
      : body_name(name), settings(std::move(motion_settings)), initial(inertia),
        reference_position(settings.origin ? *settings.origin : inertia.centre)
  {
    present.centre = inertia.centre;
    set_inertia(inertia);
    reference_at_start = inertia.centre + reference_arm;
    next = present;
  }

  template <int dim>
  void RigidBody<dim>::set_motion(const Vector &velocity, const Vector &spin, const double interval,
                                  const bool is_continued)
  {
    const Vector &axis = settings.axis;
    switch (settings.rotation)
    {
    case RigidRotation::by_angle:
      present.spin = (settings.angle_at(interval) - settings.angle_at(0.)) / interval * axis;
      break;
    case RigidRotation::about_axis:
      present.spin = (spin * axis) * axis;
      break;
    case RigidRotation::free:
      present.spin = spin;
    }
    if (settings.initial_spin && !is_continued)
      present.spin = *settings.initial_spin;

    const Vector arm_velocity = cross_product_3d(present.spin, arm(present));
    present.reference_velocity = settings.initial_velocity && !is_continued
                                     ? *settings.initial_velocity
                                     : velocity + arm_velocity;
    const Vector rate =
        (settings.displacement_at(interval) - settings.displacement_at(0.)) / interval;
    for (unsigned int d = 0; d < dim; ++d)
      if (!settings.is_free(d))
        present.reference_velocity[d] = rate[d];
    present.momentum = initial.mass * (present.reference_velocity - arm_velocity);
    const Matrix axes = orientation(present);
    const Vector in_axes = transpose(axes) * present.spin;
    present.angular_momentum = axes * (body_inertia * in_axes);
    present.beyond_nodes = axes * (inertia_beyond_nodes * in_axes);
    kinetic_energy = 0.5 * present.momentum.norm_square() / initial.mass;
    rotation_energy = 0.5 * present.spin * present.angular_momentum;
    kinetic_energy += rotation_energy;
  }

  template <int dim>
  bool RigidBody<dim>::move(const Clock &clock, const Vector &momentum,
                            const Vector &angular_momentum, State &end) const
  {
    const double step = clock.next_step;
    const Vector &axis = settings.axis;
    const Matrix turned_axes = orientation(present);
    end.momentum = momentum;
    end.centre = present.centre + step / initial.mass * momentum;
    switch (settings.rotation)
    {
    case RigidRotation::by_angle:
      end.angle = angle_at_start + settings.angle_at(clock.time + step);
      end.increment = (end.angle - present.angle) * axis;
      break;
    case RigidRotation::about_axis: {
      const double sine = step * (axis * angular_momentum) / (axis * (body_inertia * axis));
      if (!(std::abs(sine) < 1.))
        return false;
      end.increment = std::asin(sine) * axis;
      end.angle = present.angle + std::asin(sine);
      break;
    }
    case RigidRotation::free:
      if (!rigid_rotation::find_rotation(
              body_inertia, step * (transpose(turned_axes) * angular_momentum), end.increment))
        return false;
      end.turn = rigid_rotation::turned(present.turn, end.increment);
    }
    const double angle = end.increment.norm();
    end.spin =
        (angle > 0. ? std::sin(angle) / (angle * step) : 1. / step) * (turned_axes * end.increment);
    end.beyond_nodes =
        1. / step *
        (turned_axes * rigid_rotation::discrete_momentum(inertia_beyond_nodes, end.increment));
    end.angular_momentum = angular_momentum;
    if (settings.rotation != RigidRotation::free)
    {
      // The reaction of the axis is not known before; along it, moments alone count.
      end.angular_momentum =
          1. / step *
          (turned_axes * rigid_rotation::discrete_momentum(body_inertia, end.increment));
      if (settings.rotation == RigidRotation::about_axis)
        end.angular_momentum += (axis * (angular_momentum - end.angular_momentum)) * axis;
    }
    end.reference_velocity = 1. / step * (end.centre + arm(end) - present.centre - arm(present));
    return true;
  }

  template <int dim>
  typename RigidBody<dim>::Matrix RigidBody<dim>::response(const Clock &clock) const
  {
    const Vector r = arm(present);
    Matrix result;
    for (unsigned int d = 0; d < 3; ++d)
      result[d][d] = 1. / initial.mass;
    if (settings.rotation == RigidRotation::about_axis)
    {
      const Vector lever = cross_product_3d(settings.axis, r);
      result += outer_product(lever, lever) / (settings.axis * (body_inertia * settings.axis));
    }
    else if (settings.rotation == RigidRotation::free)
    {
      const Matrix axes = orientation(present), cross = rigid_rotation::cross_matrix(r);
      result += transpose(cross) * (axes * invert(body_inertia) * transpose(axes)) * cross;
    }
    for (unsigned int a = 0; a < 3; ++a)
      for (unsigned int b = 0; b < 3; ++b)
        if (a >= dim || b >= dim || settings.is_free(a) || settings.is_free(b))
          result[a][b] = a == b ? 1. : 0.; // of no use: nothing is missing there
        else
          result[a][b] *= clock.velocity_step() * clock.next_step;
    return result;
  }

  template <int dim>
  void RigidBody<dim>::find_motion(const Clock &clock, const Vector &force, const Vector &moment)
  {
    constexpr unsigned int most_iterations = 60;
    const double interval = clock.velocity_step();
    const Vector r = arm(present);
    given = {settings.force_at(clock.time), settings.moment_at(clock.time)};
    const Vector target =
        reference_at_start + settings.displacement_at(clock.time + clock.next_step);
    const double digits = std::numeric_limits<double>::epsilon() *
                          (target.norm() + present.centre.norm() + reference_arm.norm());
    const Matrix inverse_response = invert(response(clock));
    reaction = {};
    double error = 0;
    // A body that turns by moments meets prescribed motion by iteration: errors fall by Δt ω each.
    for (unsigned int iteration = 0; iteration < most_iterations; ++iteration)
    {
      const Vector at_reference = given.force + reaction.force;
      const bool has_motion =
          move(clock, present.momentum + interval * (force + at_reference),
               present.angular_momentum +
                   interval * (moment + given.moment + cross_product_3d(r, at_reference)),
               next);
      Vector missing = target - next.centre - arm(next);
      for (unsigned int d = 0; d < 3; ++d)
        if (d >= dim || settings.is_free(d))
          missing[d] = 0.;
      error = missing.norm();
      if (!has_motion || !std::isfinite(error))
        fail(clock, body_name, turns_too_far);
      if (error <= 8. * digits)
        break;
      reaction.force += inverse_response * missing;
    }
    if (error > 1e6 * digits)
      fail(clock, body_name, "cannot move as prescribed");
    if (settings.rotation != RigidRotation::free)
      reaction.moment = (next.angular_momentum - present.angular_momentum) / interval - moment -
                        given.moment - cross_product_3d(r, given.force + reaction.force);
  }

  template <int dim>
  void RigidBody<dim>::set_inertia(const RigidInertia &inertia)
  {
    present.centre += orientation(present) * (inertia.centre - initial.centre);
    initial = inertia;
    body_inertia = inertia_of(inertia.second);
    inertia_beyond_nodes = inertia_of(inertia.second - inertia.nodal_second);
    reference_arm = reference_position - inertia.centre;
  }

  template <int dim>
  typename RigidBody<dim>::Placement RigidBody<dim>::placement() const
  {
    // The points of a body that has not moved stay, to the last digit.
    Placement result;
    result.centre_at_start = initial.centre;
    result.shift = present.centre - initial.centre;
    const Matrix axes = orientation(present);
    for (unsigned int a = 0; a < 3; ++a)
      for (unsigned int b = 0; b < 3; ++b)
        result.turn[a][b] = axes[a][b] - (a == b ? 1. : 0.);
    return result;
  }

  template <int dim>
  typename RigidBody<dim>::Placement RigidBody<dim>::set_momentum(const Clock &clock,
                                                                  const Vector &momentum,
                                                                  const Vector &angular_momentum)
  {
    Clock back = clock;
    back.next_step = -clock.previous_step;
    next = present;
    if (!move(back, momentum, angular_momentum + present.beyond_nodes, next))
      fail(clock, body_name, turns_too_far);
    for (unsigned int d = 0; d < dim; ++d)
      if (!settings.is_free(d))
      {
        next.momentum[d] +=
            initial.mass * (present.reference_velocity[d] - next.reference_velocity[d]);
        next.reference_velocity[d] = present.reference_velocity[d];
      }
    const Placement result = motion_of_step(back);
    next.centre = present.centre;
    next.turn = present.turn;
    next.angle = present.angle;
    next.increment *= -1.;
    present = next;
    return result;
  }

  template <int dim>
  double RigidBody<dim>::kinetic_energy_of_rotation(const Clock &clock,
                                                    const Matrix &second_moment) const
  {
    // ½ Σ m v_{n-1/2} · v_{n+1/2} of nodes that go straight, in the body's own axes at t_n.
    const Matrix after = rigid_rotation::exponential_less_one(next.increment) / clock.next_step;
    const Matrix before =
        clock.has_present_velocities()
            ? 2. * rigid_rotation::cross_matrix(transpose(orientation(present)) * present.spin) -
                  after
            : -0.5 / clock.velocity_lag() *
                  rigid_rotation::exponential_less_one(-1. * present.increment);
    return 0.5 * trace(before * second_moment * transpose(after));
  }

  template <int dim>
  void RigidBody<dim>::complete_step(const Clock &clock, ImpulseAccount *const impulses)
  {
    const double interval = clock.velocity_step();
    const auto account = [&](const Wrench &now, Wrench &previous, double &work)
    {
      const Vector force = impulse_of_step(interval * now.force, previous.force, clock);
      const Vector moment = impulse_of_step(interval * now.moment, previous.moment, clock);
      work += present.reference_velocity * force + present.spin * moment;
    };
    account(reaction, previous_reaction, drive_work);
    account(given, previous_given, force_work);
    impulse.force += interval * reaction.force;
    impulse.moment += interval * reaction.moment;

    beyond_nodes_energy = kinetic_energy_of_rotation(clock, initial.second - initial.nodal_second);
    rotation_energy = kinetic_energy_of_rotation(clock, initial.second);
    const Vector before =
        clock.has_present_velocities() ? 2. * present.momentum - next.momentum : present.momentum;
    kinetic_energy = 0.5 / initial.mass * (before * next.momentum) + rotation_energy;

    if (impulses == nullptr)
      return;
    const Vector force = interval * (reaction.force + given.force);
    const Vector moment = interval * (reaction.moment + given.moment) +
                          cross_product_3d(present.centre + arm(present), force) -
                          (next.beyond_nodes - present.beyond_nodes);
    impulses->add(array_of(force), array_of(moment));
  }

  template <int dim>
  RigidBodyBalance RigidBody<dim>::balance() const
  {
    RigidBodyBalance result;
    result.name = body_name;
    result.position = array_of(present.centre + arm(present));
    result.rotation = array_of(settings.rotation == RigidRotation::free
                                   ? rigid_rotation::rotation_vector(present.turn)
                                   : present.angle * settings.axis);
    result.velocity = array_of(present.reference_velocity);
    result.spin = array_of(present.spin);
    result.momentum = array_of(present.momentum);
    result.angular_momentum = array_of(present.angular_momentum);
    result.impulse = array_of(impulse.force);
    result.angular_impulse = array_of(impulse.moment);
    result.work = external_work();
    result.kinetic_energy = kinetic_energy;
    result.rotation_energy = rotation_energy;
    return result;
  }

  template <int dim>
  void RigidBody<dim>::list(Records &records)
  {
    records.value("turn", present.turn).continues();
    records.value("angle", present.angle).continues();
    records.value("centre", present.centre).continues();
    records.value("momentum", present.momentum).continues();
    records.value("angular momentum", present.angular_momentum).continues();
    records.value("increment", present.increment).continues();
    records.value("spin", present.spin).continues();
    records.value("reference velocity", present.reference_velocity).continues();
    records.value("beyond nodes", present.beyond_nodes).continues();
    records.value("previous reaction", previous_reaction.force);
    records.value("previous moment", previous_reaction.moment);
    records.value("previous given force", previous_given.force);
    records.value("previous given moment", previous_given.moment);
    records.value("reference point at the start", reference_at_start);
    records.value("angle at the start", angle_at_start);
    records.value("impulse", impulse.force);
    records.value("angular impulse", impulse.moment);
    records.value("work of the drive", drive_work);
    records.value("work of given forces", force_work);
    records.value("energy beyond nodes", beyond_nodes_energy).optional().continues();
  }

  template class RigidBody<2>;
  template class RigidBody<3>;
} // namespace tombolo
