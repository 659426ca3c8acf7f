// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/model/follow_divisions.h>
#include <tombolo/model/mesh_transfer.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/remeshing/adaptive_refinement.h>
#include <tombolo/simulation/checkpoint_header.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <filesystem>
#include <functional>
#include <optional>

namespace tombolo
{
  /** The enthalpies of nodes from their temperatures. */
  template <int dim>
  void find_enthalpies(ThermalModel<dim> &heat)
  {
    ThermalState &state = heat.state;
    for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
    {
      *state.enthalpy.node(i) =
          heat.nodal_enthalpy.enthalpy(i, *state.unsmoothed_temperature.node(i));
      *state.next_enthalpy.node(i) =
          heat.nodal_enthalpy.enthalpy(i, *state.next_unsmoothed_temperature.node(i));
    }
  }

  /** Writes the state of a model whose mesh is about to be divided. Collective. */
  template <int dim>
  void write_before_division(Model<dim> &model, const Clock &clock, const std::string &file)
  {
    StateArchive archive(file, StateArchive::Mode::write, model.communicator);
    archive.divide(clock);
    serialize_model(model, archive);
    MeshTransfer<dim>::write(model, archive);
    archive.close();
  }

  /** Reads it on the divided mesh. Collective. */
  template <int dim>
  void read_after_division(Model<dim> &model, const Clock &clock, const std::string &file)
  {
    StateArchive archive(file, StateArchive::Mode::read, model.communicator);
    archive.divide(clock);
    const MeshTransfer<dim> transfer(model, archive);
    serialize_model(model, archive, &transfer);
    if (model.has_mechanics)
      // Where nodes were when the state of the points was found.
      transfer.update_volumes(model, earlier_position(model.state, clock.previous_step));
    transfer.restore_momentum(model);
    if (model.heat)
      find_enthalpies(*model.heat);
  }

  /**
   * Where AdaptiveRefinement requires another division of the mesh, transfers the state to it:
   * writes it to a file of @p directory, calls @p rebuild for the model of a run with another
   * header instead of the old one, reads the state there and books the energy that the new mesh
   * loses. Throws RunError where it cannot be; the file is removed. Collective.
   */
  template <int dim>
  void adapt_mesh(std::optional<Model<dim>> &model, MechanicalStep<dim> &step, const Clock &clock,
                  const OutputDirectory &directory, Log &log,
                  const std::function<void(CheckpointHeader)> &rebuild)
  {
    using Refinement = AdaptiveRefinement<dim>;
    auto *const refinement = model->template find_process<Refinement>();
    if (refinement == nullptr)
      return;
    const MPI_Comm communicator = model->communicator;
    const std::string file = directory.file("refinement.h5.tmp");
    const auto remove = [&]
    {
      std::error_code ignored;
      if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
        std::filesystem::remove(file, ignored);
    };
    try
    {
      const auto requested = refinement->next_divisions(*model, clock.step);
      if (!requested)
        return;
      if (model->has_mechanics)
      {
        step.check_now();
        model->begin_change();
      }
      const auto before = ModelContent::of(*model);
      const double eroded = model->heat ? model->heat->eroded_heat : 0.,
                   eroding = model->heat ? model->heat->eroding_heat : 0.;
      write_before_division(*model, clock, file);
      rebuild({"", *requested});
      log.change_nodes(model->state.partition()->n_global(), clock.step);
      read_after_division(*model, clock, file);
      if (model->heat)
      {
        model->heat->eroded_heat = eroded;
        model->heat->eroding_heat = eroding;
      }
      model->template find_process<Refinement>()->book(before, ModelContent::of(*model), *model);
    }
    catch (const InputError &error)
    {
      remove();
      throw RunError("The mesh cannot be adapted at time " + format_number(clock.time) + ", step " +
                     std::to_string(clock.step) + ": " + error.what() +
                     " `Where` in section \"Mesh/Adaptive refinement\" keeps cells as they are.");
    }
    catch (const std::exception &)
    {
      remove();
      throw;
    }
    remove();
    log.record("At time " + format_number(clock.time) + ", step " + std::to_string(clock.step) +
               ", the mesh has " +
               std::to_string(model->mesh.triangulation.n_global_active_cells()) + " cells.");
  }

  /** Makes the mesh of the file that of a run with this header. Collective. */
  template <int dim>
  typename Model<dim>::MeshChange mesh_of(const CheckpointHeader &header)
  {
    return [&header](DividedMesh<dim> &mesh) { divide(mesh, header.divisions); };
  }

  /** Rebuilds the model on the mesh of @p header, and adds to this the cells that are divided for
   * their neighbours. Collective. */
  template <int dim>
  void rebuild_model(const Parameters &parameters, CheckpointHeader &header,
                     std::optional<Model<dim>> &model)
  {
    const MPI_Comm communicator = model->communicator;
    const ExchangeCost cost = model->state.partition()->exchange_cost();
    model.emplace(parameters, communicator, mesh_of<dim>(header));
    model->state.partition()->exchange_cost() = cost;
    header.divisions = divided_cells(model->mesh);
  }
} // namespace tombolo
