// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/mesh_division.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/model/follow_divisions.h>
#include <tombolo/model/mesh_transfer.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/physics/remeshing/adaptive_refinement.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <filesystem>

namespace tombolo
{
  namespace
  {
    void remove_file(const std::string &file, const MPI_Comm communicator)
    {
      std::error_code ignored;
      if (Utilities::MPI::this_mpi_process(communicator) == 0)
        std::filesystem::remove(file, ignored);
    }

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

    template <int dim>
    void write_state(Model<dim> &model, const Clock &clock, const std::string &file)
    {
      StateArchive archive(file, StateArchive::Mode::write, model.communicator);
      archive.divide(clock);
      serialize_model(model, archive);
      MeshTransfer<dim>::write(model, archive);
      archive.close();
    }

    template <int dim>
    void read_state(Model<dim> &model, const Clock &clock, const std::string &file)
    {
      StateArchive archive(file, StateArchive::Mode::read, model.communicator);
      archive.divide(clock);
      const MeshTransfer<dim> transfer(model, archive);
      serialize_model(model, archive, &transfer);
      if (model.has_mechanics)
        // Where nodes were when the state of the points was found.
        transfer.settle_volumes(model, earlier_position(model.state, clock.previous_step));
      transfer.restore_momentum(model);
      if (model.heat)
        find_enthalpies(*model.heat);
    }
  } // namespace

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
    try
    {
      const auto wanted = refinement->next_divisions(*model, clock.step);
      if (!wanted)
        return;
      if (model->has_mechanics)
      {
        step.check_now();
        model->begin_change();
      }
      const auto before = ModelContent::of(*model);
      const double eroded = model->heat ? model->heat->eroded_heat : 0.,
                   eroding = model->heat ? model->heat->eroding_heat : 0.;
      write_state(*model, clock, file);
      rebuild({"", *wanted});
      log.change_nodes(model->state.partition()->n_global(), clock.step);
      read_state(*model, clock, file);
      if (model->heat)
      {
        model->heat->eroded_heat = eroded;
        model->heat->eroding_heat = eroding;
      }
      model->template find_process<Refinement>()->book(before, ModelContent::of(*model), *model);
    }
    catch (const InputError &error)
    {
      remove_file(file, communicator);
      throw RunError("The mesh cannot be adapted at time " + format_number(clock.time) + ", step " +
                     std::to_string(clock.step) + ": " + error.what());
    }
    remove_file(file, communicator);
    log.record("At time " + format_number(clock.time) + ", step " + std::to_string(clock.step) +
               ", the mesh has " +
               std::to_string(model->mesh.triangulation.n_global_active_cells()) + " cells.");
  }

  template <int dim>
  typename Model<dim>::MeshChange mesh_of(const CheckpointHeader &header)
  {
    return [&header](DividedMesh<dim> &mesh) { divide(mesh, header.divisions); };
  }

  bool have_same_mesh(const CheckpointHeader &one, const CheckpointHeader &other)
  {
    return one.divisions == other.divisions;
  }

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

  template void adapt_mesh(std::optional<Model<2>> &, MechanicalStep<2> &, const Clock &,
                           const OutputDirectory &, Log &,
                           const std::function<void(CheckpointHeader)> &);
  template void adapt_mesh(std::optional<Model<3>> &, MechanicalStep<3> &, const Clock &,
                           const OutputDirectory &, Log &,
                           const std::function<void(CheckpointHeader)> &);
  template Model<2>::MeshChange mesh_of<2>(const CheckpointHeader &);
  template Model<3>::MeshChange mesh_of<3>(const CheckpointHeader &);
  template void rebuild_model(const Parameters &, CheckpointHeader &, std::optional<Model<2>> &);
  template void rebuild_model(const Parameters &, CheckpointHeader &, std::optional<Model<3>> &);
} // namespace tombolo
