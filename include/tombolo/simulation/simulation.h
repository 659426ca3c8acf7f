// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/log.h>
#include <tombolo/model/model.h>

#include <mpi.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** Declares every entry and section of a parameter file of a run. */
  template <int dim>
  void declare_run_parameters(Parameters &parameters);

  /** Reads what can be read without a mesh, and refuses what is wrong with it. Throws InputError.
   * Collective. */
  template <int dim>
  void validate_run(const Parameters &parameters, MPI_Comm communicator);

  /** Reads the mesh, and refuses parts, conditions and contacts that name groups of cells or
   * boundaries which it does not have, and cells that no part, or two, would contain. Builds no
   * model. Returns the remarks of the reader of the mesh. Throws InputError. Collective. */
  template <int dim>
  std::vector<std::string> validate_mesh(const Parameters &parameters, MPI_Comm communicator);

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
    virtual ~Simulation() = default;

    /** Prints what the model is: nodes, cells, particles, neighbours, mass, extent, wave speeds,
     * time step, expected steps, memory and wall time; then warnings and advice. Collective. */
    virtual void audit() = 0;

    /** Reads the state from a checkpoint: @p checkpoint is a file or a directory of them; empty, it
     * is the newest whole one of the output directory. run() then continues there and keeps the
     * results of before. Throws InputError where there is none, where it is damaged or of another
     * model. Collective. */
    virtual void resume(const std::string &checkpoint) = 0;

    /** Runs to the end time, or until SIGINT or SIGTERM. Throws RunError. Collective. */
    virtual RunResult run() = 0;

    /** The checkpoint written last; empty if none was. */
    virtual const std::string &last_checkpoint() const = 0;

    virtual Model<dim> &get_model() = 0;
  };

  /** Builds the scene. Nothing is written yet. Throws InputError. Collective. */
  template <int dim>
  std::unique_ptr<Simulation<dim>> create_simulation(const Parameters &parameters, Log &log,
                                                     MPI_Comm communicator);
} // namespace tombolo
