#pragma once

#include <tombolo/output/energy_ledger.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/log.h>
#include <tombolo/output/output.h>
#include <tombolo/output/output_directory.h>
#include <tombolo/output/output_schedule.h>
#include <tombolo/output/statistics.h>
#include <tombolo/output/summary.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/simulation/mechanical_step.h>
#include <tombolo/simulation/scene.h>
#include <tombolo/simulation/step_size.h>

#include <memory>
#include <vector>

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
    /** Declares every section that @p parameters needs. */
    static void declare_parameters(Parameters &parameters);

    /** Reads what can be read without a mesh, and refuses what is wrong with it. */
    static void validate(const Parameters &parameters, MPI_Comm communicator);

    /** Builds the scene. Nothing is written yet. Throws InputError. Collective. */
    Simulation(const Parameters &parameters, Log &log, MPI_Comm communicator);

    /** Prints what the model is: nodes, cells, particles, neighbours, mass, extent, wave speeds,
     * time step, expected steps, memory and wall time. Collective. */
    void audit();

    /** Runs to the end time, or until SIGINT or SIGTERM. Throws RunError. Collective. */
    RunResult run();

    Scene<dim> &scene();
    EnergyBalance energy_balance();
    const Clock &clock() const;

  private:
    OutputView<dim> view() const;
    void choose_step(bool has_new_neighbours);
    void write_output();
    RunResult run_to_the_end();
    void write_summary(const std::string &ended);
    int stop_signal() const;

    const Parameters &parameters;
    Log &log;
    MPI_Comm communicator;
    double end_time;
    Scene<dim> model;
    EnergyLedger ledger;
    StepSize<dim> step_size;
    MechanicalStep<dim> step;
    Clock run_clock;
    OutputSchedule schedule;
    UnitLabels unit_labels;
    std::unique_ptr<ExactSolution<dim>> exact_solution;
    std::vector<std::unique_ptr<Output<dim>>> outputs;

    std::unique_ptr<OutputDirectory> directory;
    std::unique_ptr<Statistics> statistics;
    Summary summary;
    EnergyBalance last_balance;
    Json exact_errors;
    double loop_seconds = 0;
  };
} // namespace tombolo
