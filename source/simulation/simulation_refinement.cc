// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/model/mesh_transfer.h>
#include <tombolo/model/model_checkpoint.h>
#include <tombolo/physics/remeshing/adaptive_refinement.h>
#include <tombolo/simulation/simulation.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <filesystem>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *file_of_transfer = "refinement.h5.tmp";

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
  } // namespace

  template <int dim>
  void Simulation<dim>::rebuild_model(const CellDivisions &next)
  {
    const ExchangeCost cost = model->state.partition()->exchange_cost();
    model.emplace(parameters, communicator, next);
    model->state.partition()->exchange_cost() = cost;
    divisions = next;
    step_size.mesh_has_changed(parameters);
    if (thermal_step)
      thermal_step->mesh_has_changed();
    outputs.attach(*model, exact_errors.solution());
    outputs.check(run_clock);
  }

  template <int dim>
  void Simulation<dim>::adapt_mesh()
  {
    using Refinement = AdaptiveRefinement<dim>;
    Refinement *refinement = model->template find_process<Refinement>();
    const std::string file = directory->file(file_of_transfer);
    try
    {
      const auto wanted = refinement->next_divisions(*model, run_clock.step);
      if (!wanted)
        return;
      if (model->has_mechanics)
      {
        step.check_now();
        model->begin_change();
      }
      const auto before = Refinement::content_of(*model);
      {
        StateArchive archive(file, StateArchive::Mode::write, communicator);
        serialize_model(*model, archive);
        if (model->has_mechanics)
          step.serialize(archive);
        MeshTransfer<dim>::write(*model, archive);
        archive.close();
      }
      rebuild_model(*wanted);
      divisions = divided_cells(model->mesh); // neighbours may have been divided for others
      {
        StateArchive archive(file, StateArchive::Mode::read, communicator);
        const MeshTransfer<dim> transfer(*model, archive);
        serialize_model(*model, archive, &transfer);
        if (model->has_mechanics)
          step.serialize(archive);
        transfer.restore_momentum(*model);
      }
      if (model->heat)
        find_enthalpies(*model->heat);
      refinement = model->template find_process<Refinement>();
      refinement->book(before, Refinement::content_of(*model), *model);
    }
    catch (const InputError &error)
    {
      remove_file(file, communicator);
      throw RunError("The mesh cannot be adapted at time " + format_number(run_clock.time) +
                     ", step " + std::to_string(run_clock.step) + ": " + error.what());
    }
    remove_file(file, communicator);
    log.record("At time " + format_number(run_clock.time) + ", step " +
               std::to_string(run_clock.step) + ", the mesh has " +
               std::to_string(model->mesh.triangulation.n_global_active_cells()) + " cells.");
  }

  template void Simulation<2>::rebuild_model(const CellDivisions &);
  template void Simulation<3>::rebuild_model(const CellDivisions &);
  template void Simulation<2>::adapt_mesh();
  template void Simulation<3>::adapt_mesh();
} // namespace tombolo
