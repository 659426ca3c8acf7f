// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>

namespace tombolo
{
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
} // namespace tombolo
