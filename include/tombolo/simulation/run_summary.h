// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/json.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/model.h>
#include <tombolo/output/summary.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

namespace tombolo
{
  /** Processor time of this process since its start, of its own and of the system for it [s]. */
  inline double processor_seconds()
  {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  }

  /** A moment of a run, by both clocks. */
  struct Moment
  {
    std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
    double processor = processor_seconds();
  };

  /** What a part of a run takes on this rank [s]. */
  struct Duration
  {
    double wall = 0, processor = 0;

    void add_since(const Moment &start)
    {
      wall += seconds_since(start.wall);
      processor += processor_seconds() - start.processor;
    }
  };

  /** Times of a run, of this rank. */
  struct RunTimes
  {
    Duration loop;   ///< steps and what is written between them
    Duration output; ///< what is written

    Duration step_duration() const
    {
      return {loop.wall - output.wall, loop.processor - output.processor};
    }

    double before_resumption = 0; ///< wall time [s]
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  };

  /**
   * How the ranks have shared @p steps steps, for the summary. The exchanges of nodal values are
   * those counted by @p partition, and @p seconds the wall time of the same steps on this rank.
   *
   * `work_max_over_mean` is the imbalance: the largest over the mean of the time outside exchanges;
   * `exchange_share` the mean share of the time in them, waiting for slower ranks included;
   * `exchanges_per_step` their number; `messages_per_step_max`, `bytes_per_step_mean` and
   * `bytes_per_step_max` what a rank sends; `ghost_nodes_mean` and `ghost_nodes_max` the nodes of
   * others that it has. The same on all ranks. Collective.
   */
  inline Json describe_rank_balance(const NodePartition &partition, const double seconds,
                                    const double steps)
  {
    const ExchangeCost &cost = partition.exchange_cost();
    const auto over_ranks = [&](const double value)
    { return dealii::Utilities::MPI::min_max_avg(value, partition.communicator()); };
    const auto work = over_ranks(seconds - cost.seconds);
    const auto messages = over_ranks(static_cast<double>(cost.n_messages) / steps);
    const auto bytes = over_ranks(static_cast<double>(cost.n_doubles * sizeof(double)) / steps);
    const auto ghosts = over_ranks(partition.n_ghosts());

    Json result = Json::object();
    result["work_max_over_mean"] =
        work.avg > 0. ? work.max / work.avg : std::numeric_limits<double>::quiet_NaN();
    result["exchange_share"] = over_ranks(seconds > 0. ? cost.seconds / seconds : 0.).avg;
    result["exchanges_per_step"] = over_ranks(static_cast<double>(cost.n_exchanges) / steps).max;
    result["messages_per_step_max"] = messages.max;
    result["bytes_per_step_mean"] = bytes.avg;
    result["bytes_per_step_max"] = bytes.max;
    result["ghost_nodes_mean"] = ghosts.avg;
    result["ghost_nodes_max"] = ghosts.max;
    return result;
  }

  /** The largest speed, stress component and internal variables. Collective. */
  template <int dim>
  void add_extremes(const Model<dim> &model, TimeTable &statistics)
  {
    double largest[2] = {0., 0.}; // speed, stress component
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const v = model.state.velocity.node(i);
      largest[0] = std::max(largest[0], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    for (const Part<dim> &part : model.parts)
      for (unsigned int c = 0; c < 6; ++c)
      {
        const MaterialPoints &points = part.formulation->points();
        const double *const stress = points.component(MaterialPoints::stress, c);
        const double *const volume = points.component(MaterialPoints::volume, 0);
        for (unsigned int i = 0; i < points.size(); ++i)
          if (volume[i] > 0.) // not an unused lane of a batch of cells
            largest[1] = std::max(largest[1], std::abs(stress[i]));
      }
    statistics.add("largest speed", "L/T",
                   std::sqrt(dealii::Utilities::MPI::max(largest[0], model.communicator)));
    statistics.add("largest stress component", "M/(L T^2)",
                   dealii::Utilities::MPI::max(largest[1], model.communicator));
    const auto add_largest = [&](const std::string &field, const std::string &unit)
    {
      bool is_known = false;
      double value = std::numeric_limits<double>::lowest();
      for (const Part<dim> &part : model.parts)
      {
        const MaterialPoints &points = part.formulation->points();
        const unsigned int f = points.find_field(field);
        if (f == points.fields().size())
          continue;
        is_known = true;
        const double *const values = points.component(f, 0);
        const double *const volume = points.component(MaterialPoints::volume, 0);
        for (unsigned int i = 0; i < points.size(); ++i)
          if (volume[i] > 0.)
            value = std::max(value, values[i]);
      }
      if (is_known)
        statistics.add("largest " + field, unit,
                       dealii::Utilities::MPI::max(value, model.communicator));
    };
    add_largest("effective plastic strain", "1");
    add_largest("temperature", "K");
    add_largest("damage", "1");
  }

  /** Adds energies, momenta, what processes report, and the largest speed, stress and internal
   * variables to the present row of @p statistics. Collective. */
  template <int dim>
  void add_mechanical_statistics(const Model<dim> &model, const EnergyBalance &balance,
                                 TimeTable &statistics)
  {
    for (const EnergyAccounts::Account &account : balance.energies.accounts())
    {
      statistics.add(account.name, "M L^2/T^2", account.value);
      if (account.name == "kinetic energy")
        statistics.add("smoothed kinetic energy", "M L^2/T^2", balance.smoothed_kinetic);
    }
    statistics.add("total energy", "M L^2/T^2", balance.total);
    statistics.add("energy error", "1", balance.error);
    for (unsigned int d = 0; d < dim; ++d)
      statistics.add(std::string("momentum ") + "xyz"[d], "M L/T", balance.momentum[d]);
    for (unsigned int d = 0; d < dim; ++d)
      statistics.add(std::string("impulse ") + "xyz"[d], "M L/T", balance.impulse[d]);
    statistics.add("momentum drift", "1", balance.momentum_drift);
    for (unsigned int d = dim == 2 ? 2 : 0; d < 3; ++d)
      statistics.add(std::string("angular momentum ") + "xyz"[d], "M L^2/T",
                     balance.angular_momentum[d]);
    statistics.add("angular momentum drift", "1", balance.angular_momentum_drift);
    statistics.add("lattice mode share", "1", balance.short_wave_share);
    for (const auto &process : model.processes)
      process->observed.columns(statistics);
    add_extremes(model, statistics);
  }

  /** Adds the balance of heat, what processes report of it, and the extremes of the nodal
   * temperature. Collective. */
  template <int dim>
  void add_thermal_statistics(const Model<dim> &model, const ThermalStep<dim> &thermal_step,
                              const HeatBalance &balance, TimeTable &statistics)
  {
    const std::string energy = "M L^2/T^2";
    statistics.add("thermal steps", "1", static_cast<double>(thermal_step.n_steps()));
    for (const EnergyAccounts::Account &account : balance.heat.accounts())
      statistics.add(account.name, energy, account.value);
    for (const auto &process : model.processes)
      if (!model.has_mechanics)
        process->observed.columns(statistics);
    statistics.add("heat balance error", "1", balance.error);
    double smallest = std::numeric_limits<double>::max(), largest = -smallest;
    const NodalVector &temperature = model.heat->state.present_temperature;
    for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
    {
      if (*model.heat->bridge.mass().node(i) == 0.) // all its cells were removed
        continue;
      smallest = std::min(smallest, *temperature.node(i));
      largest = std::max(largest, *temperature.node(i));
    }
    smallest = dealii::Utilities::MPI::min(smallest, model.communicator);
    largest = dealii::Utilities::MPI::max(largest, model.communicator);
    const bool is_left = smallest <= largest; // something of the body
    statistics.add("smallest nodal temperature", "temperature", is_left ? smallest : 0.);
    statistics.add("largest nodal temperature", "temperature", is_left ? largest : 0.);
  }

  /** Adds the number of ranks, the dimension, the size of the model, and the steps. Collective. */
  template <int dim>
  void add_model_to_summary(const Model<dim> &model, const Clock &clock, Summary &summary)
  {
    const auto counts = model.counts();
    summary["ranks"] = dealii::Utilities::MPI::n_mpi_processes(model.communicator);
    summary["dimension"] = dim;
    summary["nodes"] = counts.nodes;
    summary["fe_cells"] = counts.cells;
    summary["particles"] = counts.particles;
    summary["shared_nodes"] = counts.shared_nodes;
    summary["steps"] = clock.step;
    summary["simulated_time"] = clock.time;
  }

  /** Adds time steps and errors of the balances of energy and momentum. */
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

  /** Adds thermal steps and the error of the balance of heat. Collective. */
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

  /** Adds the wall time of all steps, by phase, and of a step per cell, particle and node, the
   * processor time of all steps, summed over the ranks, and the balance of the ranks, for
   * @p n_steps steps that took @p duration on this rank. @p thermal_step is null without heat.
   * Collective. */
  template <int dim>
  void add_costs_to_summary(const Model<dim> &model, const MechanicalStep<dim> &step,
                            const ThermalStep<dim> *const thermal_step, const Duration &duration,
                            const double n_steps, Summary &summary)
  {
    const auto counts = model.counts();
    const MPI_Comm communicator = model.communicator;
    const double n_ranks = dealii::Utilities::MPI::n_mpi_processes(communicator);
    const double seconds = duration.wall;
    summary["step_seconds"] = seconds;
    summary["step_processor_seconds"] =
        dealii::Utilities::MPI::sum(duration.processor, communicator);
    summary["rank_balance"] = describe_rank_balance(*model.state.partition(), seconds, n_steps);

    // The slowest rank determines the wall time of each phase.
    Json phases = Json::object();
    double element_seconds = 0, particle_seconds = 0;
    for (const std::string phase :
         {"neighbourhoods", "smoothing", "element forces", "particle forces", "loads",
          "acceleration", "motion", "processes after the motion"})
    {
      double phase_seconds = 0;
      for (const auto &[name, value] : step.times().seconds())
        if (name == phase)
          phase_seconds = value;
      phase_seconds = dealii::Utilities::MPI::max(phase_seconds, communicator);
      phases[phase] = phase_seconds;
      if (phase == "element forces")
        element_seconds += phase_seconds;
      if (phase == "particle forces" || phase == "smoothing" || phase == "neighbourhoods")
        particle_seconds += phase_seconds;
    }
    const auto nanoseconds = [&](const double wall_seconds, const double step_count, const auto n)
    { return 1e9 * n_ranks * wall_seconds / (step_count * static_cast<double>(n)); };
    if (thermal_step != nullptr)
    {
      const double heat_seconds =
          dealii::Utilities::MPI::max(thermal_step->seconds(), communicator);
      phases["heat"] = heat_seconds;
      summary["ns_per_node_thermal_step"] = nanoseconds(
          heat_seconds, static_cast<double>(std::max(thermal_step->n_steps(), 1ul)), counts.nodes);
    }
    summary["seconds_per_phase"] = phases;
    if (!(seconds > 0))
      return;
    // Whole steps where there is one kind; its own phases where there are two.
    if (counts.cells > 0)
      summary["ns_per_cell_step"] =
          nanoseconds(counts.particles > 0 ? element_seconds : seconds, n_steps, counts.cells);
    if (counts.particles > 0)
      summary["ns_per_particle_step"] =
          nanoseconds(counts.cells > 0 ? particle_seconds : seconds, n_steps, counts.particles);
    summary["ns_per_node_step"] = nanoseconds(seconds, n_steps, counts.nodes);
  }
} // namespace tombolo
