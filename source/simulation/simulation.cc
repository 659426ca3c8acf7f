#include <tombolo/output/directory_check.h>
#include <tombolo/simulation/audit.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

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

    template <int dim>
    PartEnergies sum_of_parts(const Scene<dim> &scene)
    {
      PartEnergies sum;
      for (const Part<dim> &part : scene.parts)
      {
        const PartEnergies energies = part.formulation->energies();
        sum.elastic += energies.elastic;
        sum.plastic += energies.plastic;
        sum.hourglass += energies.hourglass;
        sum.viscous += energies.viscous;
      }
      return sum;
    }

    template <int dim>
    void print_report(const Output<dim> &output, Log &log)
    {
      const std::string report = output.report();
      if (!report.empty())
        log.print(report);
    }
  } // namespace

  template <int dim>
  void Simulation<dim>::declare_parameters(Parameters &parameters)
  {
    Scene<dim>::declare_parameters(parameters);
    ParameterHandler &handler = parameters.handler();
    Parameters::declare_mandatory(handler, "End time", Patterns::Double(),
                                  "The run ends at this time; it starts at 0. Units: T.");
    handler.declare_entry("Output directory", "output", Patterns::Anything(),
                          "Where the run leaves its results; made if it does not exist.");
    UnitLabels::declare_parameters(handler);
    handler.enter_subsection("Time step");
    StepSize<dim>::declare_parameters(handler);
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
    Scene<dim>::validate(parameters);
    StepSize<dim> step_size(parameters);
    OutputSchedule schedule(parameters.section("Output"), 0., end_time);
    UnitLabels labels(parameters.section(""));
    if (ExactSolution<dim>::is_given(parameters.section("Exact solution")))
      ExactSolution<dim> exact_solution(parameters.section("Exact solution"));
    create_outputs<dim>(parameters.section("Output"));
    Checkpoints checkpoints(parameters.section("Checkpoint"));
    for (const char *entry : {"Title", "Dimension", "Plugin libraries"})
      parameters.section("").get(entry);
    parameters.refuse_unused();
  }

  template <int dim>
  Simulation<dim>::Simulation(const Parameters &parameters, Log &log, MPI_Comm communicator)
      : parameters(parameters), log(log), communicator(communicator),
        end_time(parameters.section("").get_positive("End time")),
        model((validate(parameters, communicator), parameters), communicator),
        step_size(parameters), step(model, ledger),
        schedule(parameters.section("Output"), 0., end_time), unit_labels(parameters.section("")),
        output_names(tombolo::output_names<dim>(parameters.section("Output"))),
        outputs(create_outputs<dim>(parameters.section("Output"))),
        checkpoints(parameters.section("Checkpoint")), summary(communicator)
  {
    entries = text_of_entries(parameters);
    if (ExactSolution<dim>::is_given(parameters.section("Exact solution")))
      exact_solution = std::make_unique<ExactSolution<dim>>(parameters.section("Exact solution"));
    set_view();
  }

  template <int dim>
  Scene<dim> &Simulation<dim>::scene()
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
    return ledger.balance(model.state, *model.bridge, run_clock, sum_of_parts(model),
                          model.contact_balance());
  }

  template <int dim>
  void Simulation<dim>::audit()
  {
    print_audit(model, step_size, end_time, log);
  }

  template <int dim>
  void Simulation<dim>::set_view()
  {
    present.mesh = &model.mesh;
    present.nodes = model.nodes.get();
    present.part_cells = model.part_cells.get();
    present.state = &model.state;
    for (const auto &contact : model.contacts)
      present.contacts.push_back(contact.get());
    for (const Part<dim> &part : model.parts)
    {
      OutputPart<dim> output_part;
      output_part.name = part.name;
      output_part.formulation = part.formulation.get();
      output_part.particles = part.particles;
      output_part.shape_functions =
          part.particles != nullptr ? &part.particles->shape_functions() : nullptr;
      present.parts.push_back(output_part);
    }
    if (exact_solution && exact_solution->has_stress())
      present.exact_stress = [this](const Point<dim> &place, const double time)
      { return exact_solution->stress(place, time); };
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
  void Simulation<dim>::choose_step(const bool has_new_neighbours)
  {
    const double target = std::min(schedule.next_time(), end_time);
    if (target > run_clock.time)
      run_clock.next_step = step_size.next(model, run_clock, target, has_new_neighbours);
    else // at the end there is no coming step; the last stands in for it
      run_clock.next_step = run_clock.previous_step;
    run_clock.stable_step = step_size.stable();
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
    open_directory();
    received_signal = 0;
    const auto previous_interrupt = std::signal(SIGINT, note_signal);
    const auto previous_terminate = std::signal(SIGTERM, note_signal);
    RunResult result = RunResult::finished;
    log.start_progress(model.state.partition()->n_global(), run_clock.time, end_time,
                       run_clock.step);
    const auto loop_start = std::chrono::steady_clock::now();
    int signal = serve_requests();
    bool has_new_neighbours = step.evaluate_acceleration(run_clock);
    while (true)
    {
      const bool is_last = run_clock.time >= end_time;
      const bool is_output = is_last || schedule.is_due(run_clock.time);
      if (is_output)
        schedule.advance(run_clock.time);
      const bool stops = signal != 0 && !is_last;
      choose_step(has_new_neighbours);
      step.complete_acceleration(run_clock);
      const auto before_output = std::chrono::steady_clock::now();
      for (const auto &output : outputs)
        output->after_step(view());
      if (is_output || stops)
      {
        step.check_now();
        write_output();
      }
      output_seconds +=
          std::chrono::duration<double>(std::chrono::steady_clock::now() - before_output).count();
      Progress progress;
      progress.time = run_clock.time;
      progress.step = run_clock.step;
      progress.time_step = run_clock.next_step;
      progress.energy_error = last_balance.error;
      log.progress(progress, is_output || stops);
      if (stops)
        result = signal == SIGINT ? RunResult::interrupted : RunResult::terminated;
      if (is_last || stops)
        break;

      step.advance(run_clock);
      run_clock.advance();
      // The sum of equal steps misses an output time by round-off.
      const double target = std::min(schedule.next_time(), end_time);
      if (std::abs(run_clock.time - target) < 1e-9 * run_clock.previous_step)
        run_clock.time = target;
      signal = serve_requests();
      has_new_neighbours = step.evaluate_acceleration(run_clock);
    }
    loop_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - loop_start).count() -
        output_seconds;
    log.end_progress();
    std::signal(SIGINT, previous_interrupt);
    std::signal(SIGTERM, previous_terminate);
    write_summary(result == RunResult::finished      ? "finished"
                  : result == RunResult::interrupted ? "interrupted"
                                                     : "terminated");
    return result;
  }

  template <int dim>
  int Simulation<dim>::serve_requests()
  {
    // Ranks need not hear of a signal, or see the time pass, in the same step; they agree every few
    // steps. A signal goes before the time.
    constexpr unsigned int interval = 8;
    int request = 0;
    if (run_clock.step % interval == 0)
      request = Utilities::MPI::max(received_signal != 0 ? 1 + static_cast<int>(received_signal)
                                    : checkpoints.is_due_by_wall_time() ? 1
                                                                        : 0,
                                    communicator);
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

  template <int dim>
  void Simulation<dim>::write_output()
  {
    last_balance = energy_balance();
    const EnergyBalance &b = last_balance;
    statistics->add("time", "T", run_clock.time);
    statistics->add("step", "1", static_cast<double>(run_clock.step));
    statistics->add("time step", "T", run_clock.next_step);
    statistics->add("kinetic energy", "M L^2/T^2", b.kinetic);
    statistics->add("smoothed kinetic energy", "M L^2/T^2", b.smoothed_kinetic);
    statistics->add("elastic energy", "M L^2/T^2", b.elastic);
    statistics->add("plastic dissipation", "M L^2/T^2", b.plastic);
    statistics->add("hourglass energy", "M L^2/T^2", b.hourglass);
    statistics->add("viscous dissipation", "M L^2/T^2", b.viscous);
    statistics->add("filter dissipation", "M L^2/T^2", b.filtered);
    if (!model.contacts.empty())
    {
      statistics->add("contact energy", "M L^2/T^2", b.contact);
      statistics->add("friction heat", "M L^2/T^2", b.friction);
      statistics->add("contact damping", "M L^2/T^2", b.damping);
    }
    statistics->add("external work", "M L^2/T^2", b.external_work);
    statistics->add("total energy", "M L^2/T^2", b.total);
    statistics->add("energy error", "1", b.error);
    static const char *const axis[3] = {"x", "y", "z"};
    for (unsigned int d = 0; d < dim; ++d)
      statistics->add(std::string("momentum ") + axis[d], "M L/T", b.momentum[d]);
    for (unsigned int d = 0; d < dim; ++d)
      statistics->add(std::string("impulse ") + axis[d], "M L/T", b.impulse[d]);
    statistics->add("momentum drift", "1", b.momentum_drift);
    for (unsigned int d = dim == 2 ? 2 : 0; d < 3; ++d)
      statistics->add(std::string("angular momentum ") + axis[d], "M L^2/T", b.angular_momentum[d]);
    statistics->add("angular momentum drift", "1", b.angular_momentum_drift);
    statistics->add("lattice mode share", "1", b.short_wave_share);

    if (model.has_particles())
    {
      double n_rigid = 0;
      for (const Part<dim> &part : model.parts)
        if (part.particles != nullptr)
          n_rigid += static_cast<double>(part.particles->shape_functions().rigid_rows.size());
      statistics->add("particles without a basis", "1", Utilities::MPI::sum(n_rigid, communicator));
    }

    double largest[2] = {0., 0.}; // speed, stress component
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const v = model.state.velocity.node(i);
      largest[0] = std::max(largest[0], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    for (const Part<dim> &part : model.parts)
      for (unsigned int c = 0; c < 6; ++c)
      {
        const MaterialPoints &points = part.formulation->points();
        const double *const stress = points.component(MaterialPoints::stress, c);
        for (unsigned int i = 0; i < points.size(); ++i)
          largest[1] = std::max(largest[1], std::abs(stress[i]));
      }
    statistics->add("largest speed", "L/T",
                    std::sqrt(Utilities::MPI::max(largest[0], communicator)));
    statistics->add("largest stress component", "M/(L T^2)",
                    Utilities::MPI::max(largest[1], communicator));
    const auto add_largest = [&](const std::string &field, const std::string &unit)
    {
      bool is_known = false;
      double value = std::numeric_limits<double>::lowest();
      for (const Part<dim> &part : model.parts)
      {
        const MaterialPoints &points = part.formulation->points();
        const unsigned int f = points.find_field(field);
        if (f == points.fields().size())
          continue;
        is_known = true;
        const double *const values = points.component(f, 0);
        value = std::max(
            value, points.size() == 0 ? value : *std::max_element(values, values + points.size()));
      }
      if (is_known)
        statistics->add("largest " + field, unit, Utilities::MPI::max(value, communicator));
    };
    add_largest("effective plastic strain", "1");
    add_largest("temperature", "K");

    if (exact_solution)
    {
      std::vector<const Formulation<dim> *> formulations;
      for (const Part<dim> &part : model.parts)
        formulations.push_back(part.formulation.get());
      const ExactSolutionErrors errors = exact_solution->errors(
          formulations, model.state.initial_position, model.state.velocity, model.state.mass,
          run_clock.time, run_clock.time - 0.5 * run_clock.previous_step);
      exact_errors.insert(exact_errors.end(),
                          {run_clock.time, errors.axial_stress, errors.stress, errors.velocity});
      if (exact_solution->has_stress())
      {
        statistics->add("relative error of stress xx", "1", errors.axial_stress);
        statistics->add("relative error of stress", "1", errors.stress);
      }
      if (exact_solution->has_velocity())
        statistics->add("relative error of velocity", "1", errors.velocity);
      if (run_clock.time > 0.)
      {
        std::ostringstream line;
        line.precision(4);
        line << "  t = " << run_clock.time << ": relative L2 error";
        const auto print = [&](const char *of_what, const double error)
        {
          line << of_what;
          if (std::isfinite(error))
            line << error;
          else
            line << "undefined (the exact one vanishes)";
        };
        if (exact_solution->has_stress())
        {
          print(" of stress xx ", errors.axial_stress);
          print(", of all stress ", errors.stress);
        }
        if (exact_solution->has_velocity())
          print(exact_solution->has_stress() ? ", of velocity " : " of velocity ", errors.velocity);
        log.print(line.str());
      }
    }
    for (const auto &output : outputs)
    {
      output->write(view(), *statistics);
      print_report(*output, log);
    }
    statistics->write_row();
  }

  template <int dim>
  void Simulation<dim>::write_summary(const std::string &ended)
  {
    const auto counts = model.counts();
    // Seconds are those of this process, and so are the steps that they are shared among.
    const double steps = static_cast<double>(std::max(run_clock.step - first_step, 1ul));
    summary.set_units(unit_labels);
    summary["title"] = parameters.section("").get("Title");
    summary["ended"] = ended;
    summary["ranks"] = Utilities::MPI::n_mpi_processes(communicator);
    summary["dimension"] = dim;
    summary["nodes"] = counts.nodes;
    summary["fe_cells"] = counts.cells;
    summary["particles"] = counts.particles;
    summary["shared_nodes"] = counts.shared_nodes;
    summary["steps"] = run_clock.step;
    summary["simulated_time"] = run_clock.time;
    summary["time_step_min"] = step_size.smallest();
    summary["time_step_max"] = step_size.largest();
    summary["time_step_limit"] = step_size.limit().time_step;
    summary["time_step_estimates"] = step_size.n_estimates();
    summary["energy_error_relative"] = last_balance.error;
    summary["momentum_drift_relative"] = last_balance.momentum_drift;
    summary["angular_momentum_drift_relative"] = last_balance.angular_momentum_drift;
    summary["lattice_mode_share"] = last_balance.short_wave_share;
    summary["step_seconds"] = loop_seconds;

    // The slowest rank determines the wall time of each phase.
    Json phases = Json::object();
    double of_elements = 0, of_particles = 0;
    for (const char *phase : {"neighbourhoods", "smoothing", "element forces", "particle forces",
                              "loads", "acceleration", "motion", "lattice filter"})
    {
      double seconds = 0;
      for (const auto &[name, value] : step.times().seconds())
        if (name == phase)
          seconds = value;
      seconds = Utilities::MPI::max(seconds, communicator);
      phases[phase] = seconds;
      const std::string name = phase;
      if (name == "element forces")
        of_elements += seconds;
      if (name == "particle forces" || name == "smoothing" || name == "neighbourhoods")
        of_particles += seconds;
    }
    summary["seconds_per_phase"] = phases;
    const double n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    // Whole steps where there is one kind; its own phases where there are two.
    if (counts.cells > 0 && loop_seconds > 0)
      summary["ns_per_cell_step"] = 1e9 * n_ranks *
                                    (counts.particles > 0 ? of_elements : loop_seconds) /
                                    (steps * static_cast<double>(counts.cells));
    if (counts.particles > 0 && loop_seconds > 0)
      summary["ns_per_particle_step"] = 1e9 * n_ranks *
                                        (counts.cells > 0 ? of_particles : loop_seconds) /
                                        (steps * static_cast<double>(counts.particles));
    if (loop_seconds > 0)
      summary["ns_per_node_step"] =
          1e9 * n_ranks * loop_seconds / (steps * static_cast<double>(counts.nodes));
    if (is_resumed)
    {
      summary["resumed_from_step"] = first_step;
      summary["earlier_wall_seconds"] = earlier_wall_seconds;
    }
    if (exact_solution)
    {
      Json errors = Json::array();
      for (std::size_t i = 0; i + 3 < exact_errors.size(); i += 4)
      {
        Json entry = Json::object();
        entry["time"] = exact_errors[i];
        if (exact_solution->has_stress())
        {
          entry["stress_xx"] = exact_errors[i + 1];
          entry["stress"] = exact_errors[i + 2];
        }
        if (exact_solution->has_velocity())
          entry["velocity"] = exact_errors[i + 3];
        errors.push_back(entry);
      }
      summary.results()["errors"] = errors;
    }
    for (const auto &output : outputs)
    {
      output->finish(summary.results());
      print_report(*output, log);
    }
    summary.write(*directory);
  }

  template class Simulation<2>;
  template class Simulation<3>;
} // namespace tombolo
