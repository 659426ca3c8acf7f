// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/log.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/checkpoint_header.h>

#include <memory>

namespace tombolo
{
  /** The entry `Initial state`: the end of another run, from which this one starts. */
  template <int dim>
  struct InitialState
  {
    static void declare_parameters(const Entries &e);

    /** Refuses what can be seen to be wrong without the state. Throws InputError. */
    static void validate(const Parameters &parameters);

    /** Gives the model, as it was built, and its processes the state that the entry names, and the
     * clock the stable step there, which springs of contacts need from the first forces on. Returns
     * false where it names none. Throws InputError where there is no such state, or where it is of
     * another mesh or of other parts. Collective. */
    static bool read(const Parameters &parameters, Model<dim> &model, Clock &clock, Log &log);
  };

  /** The header of a run that begins, on the mesh of the state that the entry names, or on that of
   * the file. Its entries are known when the model has read them. Collective. */
  CheckpointHeader header_at_start(const Parameters &parameters, unsigned int dimension,
                                   MPI_Comm communicator);

  /** The static steps of a scene that has such, null otherwise; for a model that has its initial
   * state, which @p is_continued from another run. Throws InputError. Collective. */
  template <int dim>
  std::unique_ptr<StaticSteps<dim>>
  create_static_steps(const Parameters &parameters, Model<dim> &model, bool is_continued, Log &log);
} // namespace tombolo
