// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/memory.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/model/checkpoint.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/output/output_schedule.h>
#include <tombolo/output/summary.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/advice.h>
#include <tombolo/simulation/audit.h>
#include <tombolo/simulation/checkpoint_header.h>
#include <tombolo/simulation/energy_check.h>
#include <tombolo/simulation/exact_errors.h>
#include <tombolo/simulation/initial_state.h>
#include <tombolo/simulation/mesh_division.h>
#include <tombolo/simulation/plausibility.h>
#include <tombolo/simulation/requests.h>
#include <tombolo/simulation/results_owner.h>
#include <tombolo/simulation/run_outputs.h>
#include <tombolo/simulation/run_summary.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <optional>

namespace tombolo
{
  namespace
  {
    RunResult result_of(const int signal)
    {
      return signal == SIGINT ? RunResult::interrupted : RunResult::terminated;
    }

    template <int dim>
    class Run : public Simulation<dim>
    {
    public:
      Run(const Parameters &parameters, Log &log, MPI_Comm communicator)
      try : parameters(parameters), log(log),
          end_time(parameters.section("").get_positive("End time")),
          largest_energy_error(parameters.section("").get_double("Largest energy error")),
          header((validate_run<dim>(parameters, communicator),
                  header_at_start(parameters, dim, communicator))),
          model(std::in_place, parameters, communicator, mesh_of<dim>(header)),
          step_size(parameters.section("Time step")), step(*model),
          schedule(parameters.section("Output"), 0., end_time),
          outputs(parameters.section("Output")), exact_errors(parameters.section("Exact solution")),
          checkpoints(parameters.section("Checkpoint")), requests(communicator),
          summary(communicator)
      {
        statistics.set_format(TableFormat(parameters.section("Output")));
        header.entries = text_of_entries(parameters);
        const bool is_continued = InitialState<dim>::read(parameters, *model, run_clock, log);
        if (model->heat)
        {
          thermal_step = std::make_unique<ThermalStep<dim>>(parameters.section("Heat"));
          thermal_step->start(*model, run_clock.time);
        }
        statics = create_static_steps(parameters, *model, is_continued, log);
        outputs.attach(*model, exact_errors.solution());
        outputs.check(run_clock);
      }
      catch (const RunError &error)
      {
        throw InputError(parameters.file_name() + ": " + error.what()); // nothing has run yet
      }

      void audit() override
      {
        const double n_steps = print_audit(*model, step_size, thermal_step.get(), statics.get(),
                                           end_time, bytes_before, log);
        print_advice(*model, step_size, parameters, end_time, n_steps, log);
      }

      void resume(const std::string &checkpoint) override
      {
        const MPI_Comm communicator = model->communicator;
        const std::string path = parameters.section("").get("Output directory");
        const std::string file = Checkpoints::find(checkpoint, path, log, communicator);
        StateArchive archive(file, StateArchive::Mode::read, communicator);
        const CheckpointHeader earlier = read_header(archive, dim, parameters);
        refuse_changed_entries(parameters, earlier.entries, file, communicator);

        const bool is_new =
            Utilities::MPI::this_mpi_process(communicator) == 0 && !std::filesystem::exists(path);
        if (earlier.divisions != header.divisions)
          rebuild_model(earlier);
        directory = std::make_unique<OutputDirectory>(parameters.section(""), "Output directory",
                                                      communicator);
        resumption.continues_files = is_of_directory(file, path, communicator);
        try
        {
          serialize(archive);
          if (run_clock.time > end_time)
            parameters.fail("End time", "the checkpoint " + file + " is of the later time " +
                                            format_number(run_clock.time) + ".");
        }
        catch (const InputError &)
        {
          std::error_code code; // of a directory that others have filled meanwhile
          if (is_new)
            std::filesystem::remove(path, code);
          throw;
        }
        schedule.resume(run_clock.time);
        schedule.resume_statistics(run_clock.time - run_clock.previous_step);
        resumption.is_resumed = true;
        resumption.first_step = run_clock.step;
        log.print("Resumed from " + file + ": step " + std::to_string(run_clock.step) +
                  ", t = " + format_number(run_clock.time));
        if (!resumption.continues_files)
          log.warn(
              "The checkpoint is not of this output directory: pictures and histories begin here.");
      }

      /** Writes to a checkpoint, or reads from it, all that a run is between two steps. */
      void serialize(StateArchive &archive)
      {
        Records records;
        list(records.group("clock"), run_clock);
        records.archived([this](StateArchive &all) { serialize_model(*model, all); });
        if (model->has_mechanics)
        {
          ledger.list(records.group("energy ledger"), last.energy);
          step_size.list(records.group("time step"), *model);
        }
        if (thermal_step)
          thermal_step->list(records.group("thermal step"), *model, last.heat);
        if (statics)
          statics->list(records.group("statics"));
        statistics.list(records);
        records.group("exact solution", exact_errors.records).optional();
        records.group("plausibility", plausibility.records).optional();
        double wall_seconds = seconds.before_resumption + seconds_since(seconds.start);
        records.value("wall seconds", wall_seconds);
        // In another directory, where their files are not, all outputs begin again.
        if (!archive.is_reading() || resumption.continues_files)
          records.group("outputs", outputs.records);
        records.serialize(archive);
        if (archive.is_reading())
          seconds.before_resumption = wall_seconds;
      }

      const std::string &last_checkpoint() const override
      {
        return checkpoints.last_file();
      }

      RunResult run() override
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
            if (directory && model)
              write_summary("failed");
          }
          catch (const RunError &)
          {
            // The directory itself can be what failed; the first failure is the one to report.
          }
          throw;
        }
      }

      Model<dim> &get_model() override
      {
        return *model;
      }

      EnergyBalance energy_balance()
      {
        return model->has_mechanics
                   ? ledger.balance(*model, run_clock, statics ? statics->unresolved_work() : 0.)
                   : EnergyBalance();
      }

    private:
      /** Where a resumed run began; as it is, a new run. */
      struct Resumption
      {
        bool is_resumed = false;
        bool continues_files = false; ///< those of its output directory
        unsigned long first_step = 0; ///< of this process
      };

      /** The balances of the last row. */
      struct LastRow
      {
        EnergyBalance energy;
        HeatBalance heat;
      };

      void open_directory()
      {
        if (!resumption.is_resumed)
          directory = std::make_unique<OutputDirectory>(parameters.section(""), "Output directory",
                                                        model->communicator);
        const UnitLabels unit_labels(parameters.section(""));
        if (resumption.continues_files)
        {
          statistics.refuse_other(*directory, unit_labels);
          outputs.check_continuation(run_clock, *directory, unit_labels);
          directory->remove_summary();
          Checkpoints::remove_later(*directory, run_clock.step);
        }
        else
        {
          directory->remove_earlier_results();
          write_owner_of_results(parameters, *directory);
        }
        hold_results(*directory);
        statistics.open(*directory, unit_labels);
        directory->write_parameters(parameters);
        log.open_file(*directory, resumption.is_resumed);
        outputs.start(run_clock, *directory, unit_labels);
      }

      RunResult run_to_the_end()
      {
        // From the first file on; before, a signal ends the process with nothing written.
        requests.catch_signals();
        open_directory();

        RunResult result = RunResult::finished;
        log.start_progress(model->state.partition()->n_global(), run_clock.time, end_time,
                           run_clock.step);
        const Moment loop_start;
        model->state.partition()->exchange_cost() = ExchangeCost();
        int signal = serve_requests(); // which adapts the mesh, too, as the run that is resumed did
        ModelChange change;
        bool is_evaluated = evaluate(change);
        while (is_evaluated)
        {
          const bool is_last = run_clock.time >= end_time;
          const bool is_output = is_last || schedule.is_due(run_clock.time);
          if (is_output)
            schedule.advance(run_clock.time);
          const bool has_row = schedule.take_statistics_due(run_clock.time);
          const bool stops = signal != 0 && !is_last;
          choose_step(change);
          if (statics)
            statics->account(run_clock);
          else if (model->has_mechanics)
            step.complete(run_clock);
          write_histories(is_output || stops, has_row);
          log_progress(is_output || stops);
          result = stops ? result_of(signal) : result;
          if (is_last && checkpoints.keep_end_state())
            write_checkpoint(true);
          if (is_last || stops)
            break;
          if (model->has_mechanics && !statics)
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
          result = result_of(requests.received_signal());
          log.record("The run was ended within step " + std::to_string(run_clock.step) +
                     ", which has no output.");
        }
        seconds.loop.add_since(loop_start);
        log.end_progress();
        write_summary(result == RunResult::finished      ? "finished"
                      : result == RunResult::interrupted ? "interrupted"
                                                         : "terminated");
        requests.restore_signals();
        return result;
      }

      /** Brings heat to the present time, and the mechanics to the acceleration there, and returns
       * what has changed in the model. False where a signal ended it among very many thermal steps.
       */
      bool evaluate(ModelChange &change)
      {
        change = ModelChange();
        if (thermal_step && !thermal_step->advance_to(
                                *model, run_clock.time, std::min(schedule.next_time(), end_time),
                                [this] { return requests.received_signal() != 0; }))
          return false;
        if (model->has_mechanics && !statics)
          change = step.evaluate(run_clock);
        return !statics ||
               statics->solve(run_clock, [this] { return requests.received_signal() != 0; });
      }

      void choose_step(const ModelChange &change)
      {
        const double target = std::min(schedule.next_time(), end_time);
        if (change.cells)
          step_size.discard_limit();
        if (target > run_clock.time && !model->has_mechanics)
          run_clock.next_step = thermal_step->begin_step(*model, target);
        else if (target > run_clock.time && statics)
          run_clock.next_step = statics->next(run_clock, target);
        else if (target > run_clock.time)
          run_clock.next_step =
              step_size.next(*model, run_clock, target, change.stencils || change.masses);
        else // at the end there is no coming step; the last replaces it
          run_clock.next_step = run_clock.previous_step;
        if (model->has_mechanics && !statics)
          run_clock.stable_step = step_size.stable();
      }

      /** At the present time, before the motion: histories, an output where @p is_output, and
       * otherwise a row of the statistics where @p has_row. */
      void write_histories(const bool is_output, const bool has_row)
      {
        // Reading the processor time takes a share of a step that has nothing to write.
        const auto start = is_output || has_row ? std::make_optional<Moment>() : std::nullopt;
        outputs.after_step(run_clock, statics && run_clock.time >= end_time);
        if (is_output || has_row)
        {
          if (model->has_mechanics)
            step.check_now();
          write_row(is_output);
        }
        else if (model->has_mechanics && is_energy_check_due(run_clock, largest_energy_error))
        {
          step.check_now();
          last.energy = energy_balance();
          check_energy_balance(*model, last.energy, run_clock, largest_energy_error, step_size);
        }
        else if (statics) // energies of the largest load, which few steps can put in and take out
          last.energy = energy_balance();
        if (start)
          seconds.output.add_since(*start);
      }

      /** A row of the statistics, and with @p is_output all that belongs to an output. */
      void write_row(const bool is_output)
      {
        statistics.begin_row(run_clock.time, run_clock.step);
        statistics.add("time step", "T", run_clock.next_step);
        if (model->has_mechanics)
        {
          last.energy = energy_balance();
          add_mechanical_statistics(*model, last.energy, statistics);
          plausibility.update(*model, last.energy, run_clock.time);
          if (statics)
            statics->report(statistics);
        }
        if (model->heat)
        {
          last.heat = thermal_step->balance(*model);
          check_heat_balance(last.heat, run_clock);
          add_thermal_statistics(*model, *thermal_step, last.heat, statistics);
        }
        if (is_output)
        {
          exact_errors.evaluate(*model, run_clock, statistics);
          if (const std::string report = exact_errors.report(); !report.empty())
            log.print(report);
          outputs.write(run_clock, statistics, log);
        }
        // Where the energy is not finite, the message of the failure has the numbers.
        if (!model->has_mechanics || std::isfinite(last.energy.total) || largest_energy_error == 0)
          statistics.write_row();
        print_warnings(*model, run_clock, Process<dim>::Occasion::row, log);
        if (model->has_mechanics)
          check_energy_balance(*model, last.energy, run_clock, largest_energy_error, step_size);
      }

      void log_progress(const bool is_output)
      {
        const bool moves = model->has_mechanics;
        log.progress({run_clock.time, run_clock.step, run_clock.next_step,
                      moves ? "energy" : "heat", moves ? last.energy.error : last.heat.error},
                     is_output);
      }

      void write_summary(const std::string &ended)
      {
        summary.set_units(UnitLabels(parameters.section("")));
        summary["title"] = parameters.section("").get("Title");
        summary["ended"] = ended;
        add_model_to_summary(*model, run_clock, summary);
        if (model->has_mechanics)
          add_mechanics_to_summary(step_size, last.energy, summary);
        if (statics)
          statics->add_to_summary(summary.document());
        for (const auto &process : model->processes)
          process->observed.results(statistics, summary.document());
        if (model->heat)
          add_heat_to_summary(*thermal_step, last.heat, summary);
        // The wall time is that of this process, and so are the steps that it is shared among.
        const auto n_steps = std::max(run_clock.step - resumption.first_step, 1ul);
        add_costs_to_summary(*model, step, thermal_step.get(), seconds.step_duration(),
                             static_cast<double>(n_steps), summary);
        if (resumption.is_resumed)
        {
          summary["resumed_from_step"] = resumption.first_step;
          summary["earlier_wall_seconds"] = seconds.before_resumption;
        }
        print_warnings(*model, run_clock, Process<dim>::Occasion::end, log);
        summary["implausible"] = plausibility.findings();
        for (const std::string &finding : plausibility.findings())
          log.warn("Implausible: " + finding);
        exact_errors.add_to(summary.results());
        outputs.finish(summary.results(), log);
        summary.write(*directory);
      }

      /** Between two steps: writes a checkpoint where one is due. Returns the signal that requests
       * the end, or zero; the same on all ranks. */
      int serve_requests()
      {
        requests.agree(checkpoints.is_due_by_wall_time());
        const bool is_due = run_clock.step > resumption.first_step &&
                            checkpoints.is_due(run_clock.step, run_clock.time >= end_time);
        if (is_due || requests.is_checkpoint_requested())
        {
          const Moment start;
          write_checkpoint(false);
          seconds.output.add_since(start);
        }
        adapt_mesh<dim>(model, step, run_clock, *directory, log,
                        [this](CheckpointHeader mesh_header)
                        { rebuild_model(std::move(mesh_header)); });
        return requests.signal();
      }

      /** The model on the mesh of another run, in its initial state. Collective. */
      void rebuild_model(CheckpointHeader mesh_header)
      {
        mesh_header.entries = header.entries;
        header = std::move(mesh_header);
        tombolo::rebuild_model(parameters, header, model);
        step_size.mesh_has_changed(parameters);
        if (thermal_step)
          thermal_step->mesh_has_changed();
        outputs.attach(*model, exact_errors.solution());
        outputs.check(run_clock);
      }

      /** The state at the end of the run, or one to resume from. */
      void write_checkpoint(const bool is_end_state)
      {
        if (model->has_mechanics)
          step.check_now();
        const auto write = [&](StateArchive &archive)
        {
          write_header(archive, dim, header);
          serialize(archive);
        };
        if (is_end_state)
          return checkpoints.write_end_state(*directory, write);
        checkpoints.write(*directory, run_clock.step, write);
        log.record("Checkpoint " + checkpoints.last_file());
      }

      const Parameters &parameters;
      Log &log;
      double end_time;
      double largest_energy_error; ///< of the largest energy put in; zero: any
      CheckpointHeader header;     ///< of this run
      const std::size_t bytes_before = allocated_bytes();
      std::optional<Model<dim>> model; ///< rebuilt, at its address, on another division of the mesh
      EnergyLedger ledger;
      StepSize<dim> step_size;
      MechanicalStep<dim> step;
      std::unique_ptr<ThermalStep<dim>> thermal_step; ///< null in scenes without heat
      std::unique_ptr<StaticSteps<dim>> statics;      ///< instead of `step`; null: explicit steps
      Clock run_clock;
      OutputSchedule schedule;
      RunOutputs<dim> outputs;
      ExactErrors<dim> exact_errors;
      Checkpoints checkpoints;
      Requests requests;

      std::unique_ptr<OutputDirectory> directory;
      TimeTable statistics{"statistics.csv", TimeTable::Rows::in_memory};
      Summary summary;
      LastRow last;
      Plausibility plausibility;
      RunTimes seconds;
      Resumption resumption;
    };
  } // namespace

  template <int dim>
  std::unique_ptr<Simulation<dim>> create_simulation(const Parameters &parameters, Log &log,
                                                     const MPI_Comm communicator)
  {
    return std::make_unique<Run<dim>>(parameters, log, communicator);
  }

  template std::unique_ptr<Simulation<2>> create_simulation(const Parameters &, Log &, MPI_Comm);
  template std::unique_ptr<Simulation<3>> create_simulation(const Parameters &, Log &, MPI_Comm);
} // namespace tombolo
