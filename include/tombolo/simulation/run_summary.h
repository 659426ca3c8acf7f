// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/json.h>
#include <tombolo/model/model.h>
#include <tombolo/output/summary.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/simulation/run_times.h>
#include <tombolo/state/node_partition.h>

namespace tombolo
{
  /**
   * How the ranks have shared @p steps steps, for the summary. The exchanges of nodal values are
   * those counted by @p partition, and @p seconds the wall time of the same steps on this rank.
   *
   * `work_max_over_mean` is the imbalance: the largest over the mean of the time outside exchanges;
   * `exchange_share` the mean share of the time in them, waiting for slower ranks included;
   * `exchanges_per_step` their number; `messages_per_step_max`, `bytes_per_step_mean` and
   * `bytes_per_step_max` what a rank sends; `ghost_nodes_mean` and `ghost_nodes_max` the nodes of
   * others that it sees. The same on all ranks. Collective.
   */
  Json describe_rank_balance(const NodePartition &partition, double seconds, double steps);

  /** Adds energies, momenta, what processes report, and the largest speed, stress and internal
   * variables to the present row of @p statistics. Collective. */
  template <int dim>
  void add_mechanical_statistics(const Model<dim> &model, const EnergyBalance &balance,
                                 TimeTable &statistics);

  /** Adds the balance of heat, what processes report of it, and the extremes of the nodal
   * temperature. Collective. */
  template <int dim>
  void add_thermal_statistics(const Model<dim> &model, const ThermalStep<dim> &thermal_step,
                              const HeatBalance &balance, TimeTable &statistics);

  /** Adds the number of ranks, the dimension, the size of the model, and the steps. Collective. */
  template <int dim>
  void add_model_to_summary(const Model<dim> &model, const Clock &clock, Summary &summary);

  /** Adds time steps and errors of the balances of energy and momentum. */
  template <int dim>
  void add_mechanics_to_summary(const StepSize<dim> &step_size, const EnergyBalance &balance,
                                Summary &summary);

  /** Adds thermal steps and the error of the balance of heat. Collective. */
  template <int dim>
  void add_heat_to_summary(const ThermalStep<dim> &thermal_step, const HeatBalance &balance,
                           Summary &summary);

  /** Adds the wall time of all steps, by phase, and of a step per cell, particle and node, the
   * processor time of all steps, summed over the ranks, and the balance of the ranks, for
   * @p n_steps steps that took @p duration on this rank. @p thermal_step is null without heat.
   * Collective. */
  template <int dim>
  void add_costs_to_summary(const Model<dim> &model, const MechanicalStep<dim> &step,
                            const ThermalStep<dim> *thermal_step, const Duration &duration,
                            double n_steps, Summary &summary);
} // namespace tombolo
