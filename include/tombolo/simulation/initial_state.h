// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/log.h>
#include <tombolo/model/checkpoint.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/model/model_input.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/checkpoint_header.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  constexpr const char *initial_state_entry = "Initial state";

  /** The entry `Initial state`: the end of another run, from which this one starts. */
  template <int dim>
  struct InitialState
  {
    static void declare_parameters(const Entries &e)
    {
      e.text(
          initial_state_entry, "", "",
          "The state in which this run starts, at t = 0: that at the end of another run on the "
          "same "
          "mesh, `DIRECTORY/checkpoint` of its output directory (section Checkpoint, `End state`), "
          "or a file of a checkpoint. Positions, velocities, stresses, internal variables and "
          "temperatures are taken over; displacements count from the initial positions of the "
          "mesh.");
    }

    /** Checks what can be checked without the state. Throws InputError. */
    static void validate(const Parameters &parameters)
    {
      const Section root = parameters.section("");
      if (root.get(initial_state_entry).empty())
        return;
      if (!root.get("Initial conditions").empty())
        root.fail(initial_state_entry, "the entry \"Initial conditions\" says how the run starts, "
                                       "too; allowed is one of both.");
      const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
      const std::vector<Part<dim>> parts = create_parts<dim>(parameters);
      for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p].source || parts[p].formulation->can_lose_cells())
          sections[p].fail("Cells", "cells of this part can leave or come; a run with an \"Initial "
                                    "state\" keeps its cells.");
    }

    /** Sets the model, as it was built, and its processes to the state that the entry names, and
     * the clock to the stable step there, which springs of contacts need from the first forces on,
     * and to the time of its velocities.
     * Returns false where it names none. Throws InputError where there is no such state, or where
     * it is of another mesh or of other parts. Collective. */
    static bool read(const Parameters &parameters, Model<dim> &model, Clock &clock, Log &log)
    {
      const Section root = parameters.section("");
      if (root.get(initial_state_entry).empty())
        return false;
      const std::string file =
          Checkpoints::find_state(root, initial_state_entry, model.communicator);
      StateArchive archive(file, StateArchive::Mode::read, model.communicator);
      const std::string entries = read_header(archive, dim, parameters).entries;
      refuse_other_parts(parameters, entries, file, model.communicator);
      read_initial_state(model, archive);
      if (model.has_mechanics)
      {
        const double courant = courant_limit(model).time_step;
        Clock earlier;
        Records earlier_records;
        list(earlier_records.group("clock"), earlier);
        earlier_records.serialize(archive);
        clock.stable_step = earlier.stable_step > 0. ? earlier.stable_step : courant;
        if (!was_at_rest(archive) && !StaticSteps<dim>::are_chosen(parameters))
          clock.start_lag = earlier.velocity_lag();
        for (const auto &process : model.processes)
          process->records.continue_from(archive);
        const double interval = 1e-3 * courant; // short against a step
        model.conditions->prescribe_initial_velocity(model.state, 0., interval);
        throw_on_all_ranks<InputError>(model.conditions->failure(), model.communicator);
        model.bridge->positions_have_changed();
      }
      log.print("Initial state: " + file);
      return true;
    }

  private:
    /** Whether the state is of a run with static steps. */
    static bool was_at_rest(StateArchive &archive)
    {
      const auto statics = archive.group("statics");
      return archive.has("step");
    }
  };

  /** The header of a run that begins, on the mesh of the state that the entry names, or on that of
   * the file. Its entries are known when the model has read them. Collective. */
  inline CheckpointHeader header_at_start(const Parameters &parameters,
                                          const unsigned int dimension, const MPI_Comm communicator)
  {
    const Section root = parameters.section("");
    if (root.get(initial_state_entry).empty())
      return {};
    StateArchive archive(Checkpoints::find_state(root, initial_state_entry, communicator),
                         StateArchive::Mode::read, communicator);
    return read_header(archive, dimension, parameters);
  }

  /** Whether any node moves at the start. Collective. */
  template <int dim>
  bool moves_at_start(const Model<dim> &model)
  {
    bool moves = false;
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        moves = moves || model.state.unsmoothed_velocity.node(i)[d] != 0.;
    return Utilities::MPI::max(moves ? 1 : 0, model.communicator) == 1;
  }

  /** The static steps of a scene that has such, null otherwise; for a model that has its initial
   * state, which @p is_continued from another run. Throws InputError. Collective. */
  template <int dim>
  std::unique_ptr<StaticSteps<dim>> create_static_steps(const Parameters &parameters,
                                                        Model<dim> &model, const bool is_continued,
                                                        Log &log)
  {
    if (!model.has_mechanics || !StaticSteps<dim>::are_chosen(parameters))
      return nullptr;
    const std::vector<Section> starts =
        named_sections(parameters, "Initial conditions", "Initial condition");
    const bool starts_in_motion = std::any_of(
        starts.begin(), starts.end(),
        [](const Section &start) { return start.is_set("Velocity") || start.is_set("Spin"); });
    if (starts_in_motion && moves_at_start(model))
      log.warn("The initial velocities do nothing: `Time integration = " +
               parameters.raw("Time integration", "") + "` finds bodies at rest.");
    auto result = std::make_unique<StaticSteps<dim>>(parameters, model, log);
    if (is_continued)
      result->continue_from_state();
    return result;
  }
} // namespace tombolo
