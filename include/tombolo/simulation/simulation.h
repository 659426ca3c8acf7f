// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/log.h>
#include <tombolo/model/model.h>

#include <memory>
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
