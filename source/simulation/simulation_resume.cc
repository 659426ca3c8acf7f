// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/simulation/mesh_division.h>
#include <tombolo/simulation/results_owner.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <filesystem>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void Simulation<dim>::serialize(StateArchive &archive)
  {
    Records records;
    list(records.group("clock"), run_clock);
    records.archived([this](StateArchive &all) { serialize_model(*model, all); });
    if (model->has_mechanics)
    {
      ledger.list(records.group("energy ledger"), last_balance);
      step_size.list(records.group("time step"), *model);
    }
    if (thermal_step)
      thermal_step->list(records.group("thermal step"), *model, last_heat_balance);
    if (statics)
      statics->list(records.group("statics"));
    statistics.list(records);
    records.group("exact solution", exact_errors.records).optional();
    double wall_seconds = seconds.before_resumption + seconds_since(seconds.start);
    records.value("wall seconds", wall_seconds);
    // In another directory, where their files are not, all outputs start anew.
    if (!archive.is_reading() || resumption.continues_files)
      records.group("outputs", outputs.records);
    records.serialize(archive);
    if (archive.is_reading())
      seconds.before_resumption = wall_seconds;
  }

  template <int dim>
  void Simulation<dim>::write_checkpoint(const bool is_end_state)
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

  template <int dim>
  void Simulation<dim>::resume(const std::string &checkpoint)
  {
    const MPI_Comm communicator = model->communicator;
    const std::string path = parameters.section("").get("Output directory");
    const std::string file = Checkpoints::find(checkpoint, path, log, communicator);
    StateArchive archive(file, StateArchive::Mode::read, communicator);
    const CheckpointHeader earlier = read_header(archive, dim, parameters);
    refuse_changed_entries(parameters, earlier.entries, file, communicator);

    const bool is_new =
        Utilities::MPI::this_mpi_process(communicator) == 0 && !std::filesystem::exists(path);
    if (!have_same_mesh(earlier, header))
      rebuild_model(earlier);
    directory =
        std::make_unique<OutputDirectory>(parameters.section(""), "Output directory", communicator);
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

  template <int dim>
  void Simulation<dim>::open_directory()
  {
    if (!resumption.is_resumed)
      directory = std::make_unique<OutputDirectory>(parameters.section(""), "Output directory",
                                                    model->communicator);
    if (resumption.continues_files)
    {
      directory->remove_summary();
      Checkpoints::remove_later(*directory, run_clock.step);
    }
    else
    {
      directory->remove_earlier_results();
      write_owner_of_results(parameters, *directory);
    }
    hold_results(*directory);
    const UnitLabels unit_labels(parameters.section(""));
    statistics.open(*directory, unit_labels);
    directory->write_parameters(parameters);
    log.open_file(*directory, resumption.is_resumed);
    outputs.start(run_clock, *directory, unit_labels);
  }

  template void Simulation<2>::serialize(StateArchive &);
  template void Simulation<3>::serialize(StateArchive &);
  template void Simulation<2>::write_checkpoint(bool);
  template void Simulation<3>::write_checkpoint(bool);
  template void Simulation<2>::resume(const std::string &);
  template void Simulation<3>::resume(const std::string &);
  template void Simulation<2>::open_directory();
  template void Simulation<3>::open_directory();
} // namespace tombolo
