// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/run_summary.h>

#include <tombolo/simulation/rank_balance.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void add_model_to_summary(const Model<dim> &model, const Clock &clock, Summary &summary)
  {
    const auto counts = model.counts();
    summary["ranks"] = Utilities::MPI::n_mpi_processes(model.communicator);
    summary["dimension"] = dim;
    summary["nodes"] = counts.nodes;
    summary["fe_cells"] = counts.cells;
    summary["particles"] = counts.particles;
    summary["shared_nodes"] = counts.shared_nodes;
    summary["steps"] = clock.step;
    summary["simulated_time"] = clock.time;
  }

  template <int dim>
  void add_mechanics_to_summary(const StepSize<dim> &step_size, const EnergyBalance &balance,
                                Summary &summary)
  {
    summary["time_step_min"] = step_size.smallest();
    summary["time_step_max"] = step_size.largest();
    summary["time_step_limit"] = step_size.limit().time_step;
    summary["time_step_estimates"] = step_size.n_estimates();
    summary["energy_error_relative"] = balance.error;
    summary["momentum_drift_relative"] = balance.momentum_drift;
    summary["angular_momentum_drift_relative"] = balance.angular_momentum_drift;
    summary["lattice_mode_share"] = balance.short_wave_share;
  }

  template <int dim>
  void add_heat_to_summary(const ThermalStep<dim> &thermal_step, const HeatBalance &balance,
                           Summary &summary)
  {
    summary["thermal_steps"] = thermal_step.n_steps();
    summary["thermal_step_min"] = thermal_step.smallest_step();
    summary["thermal_step_max"] = thermal_step.largest_step();
    thermal_step.add_to_summary(summary);
    if (thermal_step.limit().time_step < 1e299)
      summary["thermal_step_limit"] = thermal_step.limit().time_step;
    summary["heat_balance_error_relative"] = balance.error;
  }

  template <int dim>
  void add_costs_to_summary(const Model<dim> &model, const MechanicalStep<dim> &step,
                            const ThermalStep<dim> *const thermal_step, const Duration &duration,
                            const double n_steps, Summary &summary)
  {
    const auto counts = model.counts();
    const MPI_Comm communicator = model.communicator;
    const double n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    const double seconds = duration.wall;
    summary["step_seconds"] = seconds;
    summary["step_processor_seconds"] = Utilities::MPI::sum(duration.processor, communicator);
    summary["rank_balance"] = describe_rank_balance(*model.state.partition(), seconds, n_steps);

    // The slowest rank determines the wall time of each phase.
    Json phases = Json::object();
    double of_elements = 0, of_particles = 0;
    for (const std::string phase :
         {"neighbourhoods", "smoothing", "element forces", "particle forces", "loads",
          "acceleration", "motion", "processes after the motion"})
    {
      double of_phase = 0;
      for (const auto &[name, value] : step.times().seconds())
        if (name == phase)
          of_phase = value;
      of_phase = Utilities::MPI::max(of_phase, communicator);
      phases[phase] = of_phase;
      if (phase == "element forces")
        of_elements += of_phase;
      if (phase == "particle forces" || phase == "smoothing" || phase == "neighbourhoods")
        of_particles += of_phase;
    }
    const auto nanoseconds = [&](const double of_ranks, const double of_steps, const auto n)
    { return 1e9 * n_ranks * of_ranks / (of_steps * static_cast<double>(n)); };
    if (thermal_step != nullptr)
    {
      const double of_heat = Utilities::MPI::max(thermal_step->seconds(), communicator);
      phases["heat"] = of_heat;
      summary["ns_per_node_thermal_step"] = nanoseconds(
          of_heat, static_cast<double>(std::max(thermal_step->n_steps(), 1ul)), counts.nodes);
    }
    summary["seconds_per_phase"] = phases;
    if (!(seconds > 0))
      return;
    // Whole steps where there is one kind; its own phases where there are two.
    if (counts.cells > 0)
      summary["ns_per_cell_step"] =
          nanoseconds(counts.particles > 0 ? of_elements : seconds, n_steps, counts.cells);
    if (counts.particles > 0)
      summary["ns_per_particle_step"] =
          nanoseconds(counts.cells > 0 ? of_particles : seconds, n_steps, counts.particles);
    summary["ns_per_node_step"] = nanoseconds(seconds, n_steps, counts.nodes);
  }

  template void add_model_to_summary(const Model<2> &, const Clock &, Summary &);
  template void add_mechanics_to_summary(const StepSize<2> &, const EnergyBalance &, Summary &);
  template void add_heat_to_summary(const ThermalStep<2> &, const HeatBalance &, Summary &);
  template void add_costs_to_summary(const Model<2> &, const MechanicalStep<2> &,
                                     const ThermalStep<2> *, const Duration &, double, Summary &);
  template void add_model_to_summary(const Model<3> &, const Clock &, Summary &);
  template void add_mechanics_to_summary(const StepSize<3> &, const EnergyBalance &, Summary &);
  template void add_heat_to_summary(const ThermalStep<3> &, const HeatBalance &, Summary &);
  template void add_costs_to_summary(const Model<3> &, const MechanicalStep<3> &,
                                     const ThermalStep<3> *, const Duration &, double, Summary &);
} // namespace tombolo
