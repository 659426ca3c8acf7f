// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/log.h>
#include <tombolo/base/memory.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/model/checkpoint.h>
#include <tombolo/model/model.h>
#include <tombolo/output/output_schedule.h>
#include <tombolo/output/summary.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/checkpoint_header.h>
#include <tombolo/simulation/exact_errors.h>
#include <tombolo/simulation/plausibility.h>
#include <tombolo/simulation/requests.h>
#include <tombolo/simulation/run_outputs.h>
#include <tombolo/simulation/run_times.h>

#include <memory>
#include <optional>
#include <string>

namespace tombolo
{
  /** How a run ended. */
  enum class RunResult
  {
    finished,
    interrupted,
    terminated
  };

  /** One run of a parameter file, from reading to the summary. */
  template <int dim>
  class Simulation
  {
  public:
    /** Builds the scene. Nothing is written yet. Throws InputError. Collective. */
    Simulation(const Parameters &parameters, Log &log, MPI_Comm communicator);

    /** Prints what the model is: nodes, cells, particles, neighbours, mass, extent, wave speeds,
     * time step, expected steps, memory and wall time; then warnings and advice. Collective. */
    void audit();

    /** Takes the state from a checkpoint: @p checkpoint is a file or a directory of them; empty, it
     * is the newest whole one of the output directory. run() then continues there and keeps the
     * results of before. Throws InputError where there is none, where it is damaged or of another
     * model. Collective. */
    void resume(const std::string &checkpoint);

    /** Writes to a checkpoint, or reads from it, all that a run is between two steps. */
    void serialize(StateArchive &archive);

    /** The checkpoint written last; empty if none was. */
    const std::string &last_checkpoint() const
    {
      return checkpoints.last_file();
    }

    /** Runs to the end time, or until SIGINT or SIGTERM. Throws RunError. Collective. */
    RunResult run();

    Model<dim> &get_model()
    {
      return *model;
    }
    EnergyBalance energy_balance();
    const Clock &clock() const
    {
      return run_clock;
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

    void open_directory();
    RunResult run_to_the_end();
    /** Brings heat to the present time, and the mechanics to the acceleration there, and says
     * what has changed in the model. False where a signal ended it among very many thermal steps.
     */
    bool evaluate(ModelChange &change);
    void choose_step(const ModelChange &change);
    /** At the present time, before the motion: histories, an output where @p is_output, and
     * otherwise a row of the statistics where @p has_row. */
    void write_histories(bool is_output, bool has_row);
    /** A row of the statistics, and with @p is_output all that belongs to an output. */
    void write_row(bool is_output);
    void log_progress(bool is_output);
    void write_summary(const std::string &ended);
    /** Between two steps: writes a checkpoint where one is due. Returns the signal that asks for
     * the end, or zero; the same on all ranks. */
    int serve_requests();
    /** The model on the mesh of another run, in its initial state. Collective. */
    void rebuild_model(CheckpointHeader of_mesh);
    /** The state at the end of the run, or one to resume from. */
    void write_checkpoint(bool is_end_state);

    const Parameters &parameters;
    Log &log;
    double end_time;
    double largest_energy_error; ///< of the largest energy put in; zero: any
    CheckpointHeader header;     ///< of this run
    const std::size_t bytes_before = allocated_bytes();
    std::optional<Model<dim>> model; ///< built anew, at its place, on another division of the mesh
    EnergyLedger ledger;
    StepSize<dim> step_size;
    MechanicalStep<dim> step;
    std::unique_ptr<ThermalStep<dim>> thermal_step; ///< null in scenes without heat
    std::unique_ptr<StaticSteps<dim>> statics;      ///< in place of `step`; null: explicit steps
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
} // namespace tombolo
