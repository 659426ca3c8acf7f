// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/directory_check.h>
#include <tombolo/model/model_input.h>
#include <tombolo/simulation/audit.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    volatile std::sig_atomic_t received_signal = 0;

    extern "C" void note_signal(int signal)
    {
      received_signal = signal;
    }

    RunResult result_of(const int signal)
    {
      return signal == SIGINT ? RunResult::interrupted : RunResult::terminated;
    }
  } // namespace

  template <int dim>
  void Simulation<dim>::declare_parameters(Parameters &parameters)
  {
    Model<dim>::declare_parameters(parameters);
    ParameterHandler &handler = parameters.handler();
    Parameters::declare_mandatory(handler, "End time", Patterns::Double(),
                                  "The run ends at this time; it starts at 0. Units: T.");
    handler.declare_entry(
        "Largest energy error", "0.5", Patterns::Double(0.),
        "The run stops at an output where the energy balance is off by more than this fraction of "
        "the largest total energy so far, as it is when the motion is not stable; 0 is no limit.");
    handler.declare_entry("Output directory", "output", Patterns::Anything(),
                          "Where the run leaves its results; made if it does not exist.");
    UnitLabels::declare_parameters(handler);
    handler.enter_subsection("Time step");
    StepSize<dim>::declare_parameters(handler);
    MechanicalStep<dim>::declare_parameters(handler);
    handler.leave_subsection();
    handler.enter_subsection("Output");
    OutputSchedule::declare_parameters(handler);
    declare_outputs<dim>(handler);
    handler.leave_subsection();
    handler.enter_subsection("Exact solution");
    ExactSolution<dim>::declare_parameters(handler);
    handler.leave_subsection();
    handler.enter_subsection("Checkpoint");
    Checkpoints::declare_parameters(handler);
    handler.leave_subsection();
  }

  template <int dim>
  void Simulation<dim>::validate(const Parameters &parameters, const MPI_Comm communicator)
  {
    const double end_time = parameters.section("").get_positive("End time");
    const std::string directory = parameters.section("").get("Output directory");
    const std::string obstacle = Utilities::MPI::broadcast(
        communicator,
        Utilities::MPI::this_mpi_process(communicator) == 0 ? what_prevents_directory(directory)
                                                            : "",
        0);
    if (!obstacle.empty())
      parameters.fail("Output directory", obstacle);
    const Physics<dim> physics = Model<dim>::validate(parameters);
    if (physics.has_mechanics)
      StepSize<dim> step_size(parameters);
    OutputSchedule schedule(parameters.section("Output"), 0., end_time);
    UnitLabels labels(parameters.section(""));
    ExactSolution<dim>::validate(parameters.section("Exact solution"), physics.has_mechanics,
                                 physics.has_heat);
    create_outputs<dim>(parameters.section("Output"));
    Checkpoints checkpoints(parameters.section("Checkpoint"));
    for (const char *entry : {"Title", "Dimension", "Plugin libraries", "Largest energy error"})
      parameters.section("").get(entry);
    parameters.refuse_unused();
  }

  template <int dim>
  Simulation<dim>::Simulation(const Parameters &parameters, Log &log, MPI_Comm communicator)
  try : parameters(parameters), log(log), communicator(communicator),
      end_time(parameters.section("").get_positive("End time")),
      largest_energy_error(parameters.section("").get_double("Largest energy error")),
      model((validate(parameters, communicator), parameters), communicator), step_size(parameters),
      step(model, parameters.section("Time step")),
      schedule(parameters.section("Output"), 0., end_time), unit_labels(parameters.section("")),
      output_names(tombolo::output_names<dim>(parameters.section("Output"))),
      outputs(create_outputs<dim>(parameters.section("Output"))),
      checkpoints(parameters.section("Checkpoint")), summary(communicator)
  {
    entries = text_of_entries(parameters);
    if (model.heat)
    {
      thermal_step = std::make_unique<ThermalStep<dim>>(parameters.section("Heat"));
      thermal_step->start(model, run_clock.time);
    }
    if (ExactSolution<dim>::is_given(parameters.section("Exact solution")))
      exact_solution = std::make_unique<ExactSolution<dim>>(parameters.section("Exact solution"));
    set_view();
    for (const auto &output : outputs)
      output->check(view());
  }
  catch (const RunError &error)
  {
    throw InputError(error.what()); // nothing has run yet
  }

  template <int dim>
  Model<dim> &Simulation<dim>::get_model()
  {
    return model;
  }

  template <int dim>
  const Clock &Simulation<dim>::clock() const
  {
    return run_clock;
  }

  template <int dim>
  EnergyBalance Simulation<dim>::energy_balance()
  {
    if (!model.has_mechanics)
      return {};
    return ledger.balance(model, run_clock);
  }

  template <int dim>
  void Simulation<dim>::audit()
  {
    print_audit(model, step_size, thermal_step.get(), end_time, log);
  }

  template <int dim>
  void Simulation<dim>::set_view()
  {
    present.mesh = &model.mesh;
    present.nodes = model.nodes.get();
    present.part_cells = model.part_cells.get();
    present.state = &model.state;
    present.has_mechanics = model.has_mechanics;
    present.heat = model.heat ? &model.heat->state : nullptr;
    for (const auto &process : model.processes)
      process->show(present);
    for (const Part<dim> &part : model.parts)
    {
      OutputPart<dim> output_part;
      output_part.name = part.name;
      output_part.formulation = part.formulation.get();
      output_part.particles = part.particles;
      output_part.stencils = part.particles != nullptr ? &part.particles->stencils() : nullptr;
      present.parts.push_back(output_part);
    }
    if (exact_solution && exact_solution->has_stress())
      present.exact_stress = [this](const Point<dim> &place, const double time)
      { return exact_solution->stress(place, time); };
    if (exact_solution && exact_solution->has_temperature())
      present.exact_temperature = [this](const Point<dim> &place, const double time)
      { return exact_solution->temperature(place, time); };
  }

  template <int dim>
  const OutputView<dim> &Simulation<dim>::view()
  {
    present.time = run_clock.time;
    present.step = run_clock.step;
    present.time_step = run_clock.next_step;
    return present;
  }

  template <int dim>
  void Simulation<dim>::choose_step(const ModelChange &change)
  {
    const double target = std::min(schedule.next_time(), end_time);
    if (change.cells)
      step_size.forget_limit();
    if (target > run_clock.time && !model.has_mechanics)
      run_clock.next_step = thermal_step->begin_step(model, target);
    else if (target > run_clock.time)
      run_clock.next_step =
          step_size.next(model, run_clock, target, change.stencils || change.masses);
    else // at the end there is no coming step; the last stands in for it
      run_clock.next_step = run_clock.previous_step;
    if (model.has_mechanics)
      run_clock.stable_step = step_size.stable();
  }

  template <int dim>
  bool Simulation<dim>::evaluate(ModelChange &change)
  {
    change = ModelChange();
    if (thermal_step &&
        !thermal_step->bring_to(model, run_clock.time, std::min(schedule.next_time(), end_time),
                                [this] { return agreed_signal() != 0; }))
      return false;
    if (model.has_mechanics)
      change = step.evaluate(run_clock);
    return true;
  }

  template <int dim>
  int Simulation<dim>::agreed_signal() const
  {
    return Utilities::MPI::max(static_cast<int>(received_signal), communicator);
  }

  template <int dim>
  RunResult Simulation<dim>::run()
  {
    try
    {
      return run_to_the_end();
    }
    catch (const RunError &error)
    {
      log.end_progress();
      log.record(std::string("The run stopped: ") + error.what());
      summary["failure"] = error.what();
      try
      {
        if (directory)
          write_summary("failed");
      }
      catch (const RunError &)
      {
        // The directory itself can be what failed; the first failure is the one to report.
      }
      throw;
    }
  }

  template <int dim>
  RunResult Simulation<dim>::run_to_the_end()
  {
    // From the first file on; before, a signal ends the process with nothing written.
    received_signal = 0;
    const auto previous_interrupt = std::signal(SIGINT, note_signal);
    const auto previous_terminate = std::signal(SIGTERM, note_signal);
    open_directory();
    RunResult result = RunResult::finished;
    log.start_progress(model.state.partition()->n_global(), run_clock.time, end_time,
                       run_clock.step);
    const auto loop_start = std::chrono::steady_clock::now();
    model.state.partition()->exchange_cost() = ExchangeCost();
    int signal = serve_requests();
    ModelChange change;
    bool is_evaluated = evaluate(change);
    while (is_evaluated)
    {
      const bool is_last = run_clock.time >= end_time;
      const bool is_output = is_last || schedule.is_due(run_clock.time);
      if (is_output)
        schedule.advance(run_clock.time);
      const bool stops = signal != 0 && !is_last;
      choose_step(change);
      if (model.has_mechanics)
        step.complete(run_clock);
      const auto before_output = std::chrono::steady_clock::now();
      for (const auto &output : outputs)
        output->after_step(view());
      if (is_output || stops)
      {
        if (model.has_mechanics)
          step.check_now();
        write_output();
      }
      output_seconds +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - before_output).count();
      Progress progress;
      progress.time = run_clock.time;
      progress.step = run_clock.step;
      progress.time_step = run_clock.next_step;
      progress.balance = model.has_mechanics ? "energy" : "heat";
      progress.balance_error = model.has_mechanics ? last_balance.error : last_heat_balance.error;
      log.progress(progress, is_output || stops);
      if (stops)
        result = result_of(signal);
      if (is_last || stops)
        break;

      if (model.has_mechanics)
        step.advance(run_clock);
      run_clock.advance();
      // The sum of equal steps misses an output time by round-off.
      const double target = std::min(schedule.next_time(), end_time);
      if (std::abs(run_clock.time - target) < 1e-9 * run_clock.previous_step)
        run_clock.time = target;
      signal = serve_requests();
      is_evaluated = evaluate(change);
    }
    if (!is_evaluated)
    {
      signal = agreed_signal();
      result = result_of(signal);
      log.record("The run was ended among the thermal steps of step " +
                 std::to_string(run_clock.step) + ", which has no output.");
    }
    loop_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - loop_start).count() -
        output_seconds;
    log.end_progress();
    write_summary(result == RunResult::finished      ? "finished"
                  : result == RunResult::interrupted ? "interrupted"
                                                     : "terminated");
    std::signal(SIGINT, previous_interrupt);
    std::signal(SIGTERM, previous_terminate);
    return result;
  }

  template <int dim>
  int Simulation<dim>::serve_requests()
  {
    // Ranks need not hear of a signal, or see the time pass, in the same step; they agree every few
    // steps, as many as take a part of a second. A signal goes before the time.
    constexpr unsigned int most_steps = 8;
    constexpr double seconds = 0.25;
    int request = 0;
    if (--steps_to_agreement == 0)
    {
      const double now = seconds_since_start();
      const int own = received_signal != 0                ? 1 + static_cast<int>(received_signal)
                      : checkpoints.is_due_by_wall_time() ? 1
                                                          : 0;
      std::vector<double> of_all(2);
      Utilities::MPI::max(std::vector<double>{double(own), now - last_agreement}, communicator,
                          of_all);
      request = static_cast<int>(of_all[0]);
      const double step_seconds = of_all[1] / steps_between_agreements;
      steps_between_agreements = static_cast<unsigned int>(
          std::clamp(seconds / std::max(step_seconds, 1e-9), 1., double(most_steps)));
      steps_to_agreement = steps_between_agreements;
      last_agreement = now;
    }
    const bool is_due = run_clock.step > first_step &&
                        (checkpoints.is_due(run_clock.step) || run_clock.time >= end_time);
    if (checkpoints.are_on() && (is_due || request > 0))
    {
      const auto before = std::chrono::steady_clock::now();
      write_checkpoint();
      output_seconds +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    }
    return std::max(request - 1, 0);
  }

  template <int dim>
  double Simulation<dim>::seconds_since_start() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  template class Simulation<2>;
  template class Simulation<3>;
} // namespace tombolo
