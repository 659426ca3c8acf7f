// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/work_while_waiting.h>

#include <cmath>
#include <string>

namespace tombolo
{
  namespace
  {
    /** target += factor · increment at owned nodes. */
    void add_scaled(const double factor, const NodalVector &increment, NodalVector &target)
    {
      for (unsigned int i = 0; i < target.partition()->n_owned(); ++i)
        store_node(load_node(target.node(i)) + load_node(increment.node(i)) * factor,
                   target.node(i));
    }

    template <int dim>
    const NodalVector *present_temperature(const Model<dim> &model)
    {
      return model.heat ? &model.heat->state.present_temperature : nullptr;
    }
  } // namespace

  template <int dim>
  void CentralDifferences<dim>::advance(Model<dim> &model, const Clock &clock)
  {
    Bridge &bridge = *model.bridge;
    const NodalVector &v = model.state.velocity, &a = model.state.acceleration;
    NodalVector &v_hat = model.state.unsmoothed_velocity, &x = model.state.position;
    const double dt_n = clock.velocity_step(), dt = clock.next_step;
    switch (bridge.operators())
    {
    case Bridge::Operators::identity:
    case Bridge::Operators::interpolation:
      bridge.add_interpolated_motion(v, a, dt_n, dt, v_hat, x); // (22)-(25), (52)-(56)
      break;
    case Bridge::Operators::sharpened:
      rate.fit_to(x.partition());
      field.fit_to(x.partition());
      bridge.velocity_rate(model.state, dt_n, rate);
      add_scaled(dt_n, rate, v_hat); // (22), (55), (56)
      for (std::size_t i = 0; i < std::size_t(x.partition()->n_local()) * node_stride; ++i)
        field.data()[i] = v.data()[i] + dt_n * a.data()[i]; // (23)
      bridge.apply_interpolation(field, rate);
      add_scaled(dt, rate, x); // (24), (25), (52)-(54)
      break;
    case Bridge::Operators::affine: {
      const NodalVector &momentum = bridge.momentum_rate(model.state, dt_n);
      v_hat.fill(
          [&](const unsigned int i, double *const velocity)
          {
            const double mass = *bridge.mass().node(i);
            store_node(load_node(velocity) +
                           load_node(momentum.node(i)) * (mass > 0. ? dt_n / mass : 0.),
                       velocity);
          });
      bridge.move_with_smoothed_velocity(model.state, dt); // x = S x̂, (10)-(12)
    }
    }
    bridge.positions_have_changed();
    x.distribute();
    // The scatter of eq. (10) reads owned values only.
    if (bridge.operators() == Bridge::Operators::identity || x.partition()->has_dependent_nodes())
      v_hat.distribute();
  }

  template class CentralDifferences<2>;
  template class CentralDifferences<3>;

  template <int dim>
  ModelChange MechanicalStep<dim>::evaluate(const Clock &clock)
  {
    failures.end();
    stopwatch.start();
    ModelChange change;
    for (const auto &process : model.processes)
      change |= process->change_model(model, clock); // cells, φ, ∇φ, masses
    stopwatch.lap("neighbourhoods");
    smooth_velocity(clock);    // (10)-(12), (48)-(50)
    add_internal_force(clock); // (13), (5), (16), (19), (51)
    for (const auto &process : model.processes)
      process->act(model, clock, model.state.force);
    stopwatch.lap("loads");
    divide_by_mass(clock); // (20)
    failures.begin();
    stopwatch.lap("acceleration");
    return change;
  }

  template <int dim>
  void MechanicalStep<dim>::complete(const Clock &clock)
  {
    stopwatch.start();
    for (const auto &process : model.processes)
      process->constrain(model, clock);
    model.state.acceleration.distribute();
    model.impulses.begin_step();
    for (const auto &process : model.processes)
      process->complete_step(model, clock);
    stopwatch.lap("acceleration");
  }

  template <int dim>
  void MechanicalStep<dim>::advance(const Clock &clock)
  {
    stopwatch.start();
    differences.advance(model, clock); // (22)-(25), (52)-(56)
    stopwatch.lap("motion");
    for (const auto &process : model.processes)
      process->after_motion(model, clock, model.state);
    stopwatch.lap("processes after the motion");
  }

  template <int dim>
  MechanicalStep<dim>::MechanicalStep(Model<dim> &model)
      : model(model), assembly(model.parts), failures(model.communicator)
  {}

  template <int dim>
  void MechanicalStep<dim>::evaluate_part(const std::size_t number, const Clock &clock,
                                          const std::function<void()> &add_force)
  {
    const Part<dim> &part = model.parts[number];
    // A failure is on one rank alone; all must be notified before any throws.
    std::string failure;
    try
    {
      add_force();
      failure = part.formulation->failure();
    }
    catch (const RunError &error)
    {
      failure = error.what();
    }
    if (!failure.empty())
      failures.note("At time " + format_number(clock.time) + ", step " +
                    std::to_string(clock.step) + ", part \"" + part.name + "\": " + failure);
  }

  template <int dim>
  void MechanicalStep<dim>::smooth_velocity(const Clock &clock)
  {
    NodalState &state = model.state;
    state.force.set_zero();
    forces_while_waiting.begin(model);
    const auto add_next = [&](const bool as_a_piece)
    {
      forces_while_waiting.add_next(
          {&state.position, &state.unsmoothed_velocity, clock.previous_step,
           present_temperature(model)},
          [&](const std::size_t number, const auto &add_force)
          { evaluate_part(number, clock, add_force); },
          as_a_piece, state.force);
    };
    const auto work = [&](const WorkWhileWaiting::HasArrived &has_arrived)
    {
      stopwatch.lap("smoothing");
      while (forces_while_waiting.are_left() && !has_arrived())
        add_next(true);
      stopwatch.lap("element forces");
    };
    {
      const WorkWhileWaiting while_waiting(work);
      model.bridge->smooth_velocity(state);
    }
    stopwatch.lap("smoothing");
    while (forces_while_waiting.are_left())
      add_next(false);
    stopwatch.lap("element forces");
  }

  template <int dim>
  void MechanicalStep<dim>::add_internal_force(const Clock &clock)
  {
    const auto evaluate = [&](const std::size_t number, const std::function<void()> &add_force)
    {
      evaluate_part(number, clock, add_force);
      stopwatch.lap(model.parts[number].formulation->phase());
    };
    const NodalVector *const temperature = present_temperature(model);
    const auto add = [&](const Part<dim> &part, const NodalVector &velocity, NodalVector &force)
    {
      const auto number = static_cast<std::size_t>(&part - model.parts.data());
      const MechanicalInput input{&model.state.position, &velocity, clock.previous_step,
                                  temperature};
      model.signals.part_force(number, force, false);
      if (forces_while_waiting.are_in(number))
        forces_while_waiting.add_rest_of(number, input, evaluate, force);
      else
        evaluate(
            number,
            [&] { model.step_groups.add_internal_force(number, *part.formulation, input, force); });
      model.signals.part_force(number, force, true);
    };
    assembly.assemble(*model.bridge, model.state.velocity, model.state.force, add, true);
    model.step_groups.add_further_forces(model, clock, temperature, evaluate, model.state.force);
  }

  template <int dim>
  void MechanicalStep<dim>::divide_by_mass(const Clock &clock)
  {
    const auto note = [&](const std::string &failure)
    {
      if (!failure.empty())
        failures.note("In step " + std::to_string(clock.step) + ": " + failure);
    };
    note(model.conditions->failure());
    for (const auto &process : model.processes)
      note(process->failure);
    NodalState &state = model.state;
    const unsigned int n_owned = state.partition()->n_owned();
    const NodalVector &mass = model.bridge->nodal_mass();
    NodeLanes sum = 0.;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const NodeLanes acceleration = load_node(state.force.node(i)) / load_node(mass.node(i));
      store_node(acceleration, state.acceleration.node(i));
      sum += acceleration * 0.; // not finite where a term is not
    }
    if (std::isfinite(sum[0] + sum[1] + sum[2]) || failures.has_failure())
      return;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const a = state.acceleration.node(i);
      if (std::isfinite(a[0] + a[1] + a[2]))
        continue;
      const auto place = [i](const NodalVector &position)
      { return position_text(vector_of<dim>(position.node(i))); };
      failures.note(
          as_text("The acceleration of node ", model.nodes->persistent_ids()[std::size_t(i)],
                  " is not finite at time ", clock.time, ", step ", clock.step, ". It is at ",
                  place(state.position), ", initially at ", place(state.initial_position),
                  ". A smaller time step, or another formulation there, may help."));
      return;
    }
  }

  template class MechanicalStep<2>;
  template class MechanicalStep<3>;
} // namespace tombolo
