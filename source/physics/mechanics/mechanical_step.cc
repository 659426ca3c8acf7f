// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/vectorization.h>

#include <cmath>
#include <sstream>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ModelChange MechanicalStep<dim>::evaluate(const Clock &clock)
  {
    failures.end();
    stopwatch.start();
    ModelChange change;
    for (const auto &process : model.processes)
      change |= process->change_model(model, clock); // cells, φ, ∇φ, masses
    stopwatch.lap("neighbourhoods");
    model.bridge->smooth_velocity(model.state); // (10)-(12), (48)-(50)
    stopwatch.lap("smoothing");
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
      process->after_motion(model, clock);
    stopwatch.lap("processes after the motion");
  }

  template <int dim>
  MechanicalStep<dim>::MechanicalStep(Model<dim> &model)
      : model(model), assembly(model.parts), failures(model.communicator)
  {}

  template <int dim>
  void MechanicalStep<dim>::add_internal_force(const Clock &clock)
  {
    const NodalVector *const temperature =
        model.heat ? &model.heat->state.present_temperature : nullptr;
    const auto add = [&](const Part<dim> &part, const NodalVector &velocity, NodalVector &force)
    {
      const auto number = static_cast<std::size_t>(&part - model.parts.data());
      for (const auto &process : model.processes)
        process->part_force(number, force, false);
      // A failure is known to one rank alone; all must hear of it before any leaves.
      std::string failure;
      try
      {
        part.formulation->add_internal_force(
            {&model.state.position, &velocity, clock.previous_step, temperature}, force);
        failure = part.formulation->failure();
      }
      catch (const RunError &error)
      {
        failure = error.what();
      }
      if (!failure.empty())
        failures.note("At time " + format_number(clock.time) + ", step " +
                      std::to_string(clock.step) + ", part \"" + part.name + "\": " + failure);
      for (const auto &process : model.processes)
        process->part_force(number, force, true);
      stopwatch.lap(part.formulation->phase());
    };
    assembly.assemble(*model.bridge, model.state.velocity, model.state.force, add);
  }

  template <int dim>
  void MechanicalStep<dim>::divide_by_mass(const Clock &clock)
  {
    for (const auto &process : model.processes)
      if (const std::string failure = process->failure(); !failure.empty())
        failures.note("In step " + std::to_string(clock.step) + ": " + failure);
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
      const double *const x = state.position.node(i);
      const double *const start = state.initial_position.node(i);
      std::ostringstream message;
      message.precision(6);
      message << "The acceleration of node " << model.nodes->persistent_ids()[std::size_t(i)]
              << " is not finite at time " << clock.time << ", step " << clock.step
              << ". It is at (" << x[0] << ", " << x[1] << ", " << x[2] << "), initially at ("
              << start[0] << ", " << start[1] << ", " << start[2]
              << "). A smaller time step, or another formulation there, may help.";
      failures.note(message.str());
      return;
    }
  }

  template <int dim>
  void MechanicalStep<dim>::check_now()
  {
    failures.end();
  }

  template <int dim>
  const Stopwatch &MechanicalStep<dim>::times() const
  {
    return stopwatch;
  }

  template class MechanicalStep<2>;
  template class MechanicalStep<3>;
} // namespace tombolo
