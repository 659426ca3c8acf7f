// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/step_size.h>

namespace tombolo
{
  /** Whether the step is one in which the balance is looked at between outputs, which takes half as
   * long as a step; @p limit is that of check_energy_balance(). */
  inline bool is_energy_check_due(const Clock &clock, const double limit)
  {
    constexpr unsigned long interval = 100;
    return limit > 0. && clock.step % interval == 0;
  }

  /** Throws RunError on all ranks where the energy balance is off by more than @p limit of the
   * largest energy put in (zero: no limit) and by more than the round-off of the energies, or of
   * the smallest numbers. That of a body at rest is all round-off. The message says what helps:
   * @p step_size has chosen the steps, and none where bodies are at rest. Collective. */
  template <int dim>
  void check_energy_balance(const Model<dim> &model, const EnergyBalance &balance,
                            const Clock &clock, double limit, const StepSize<dim> &step_size);

  /** Throws RunError where the balance of heat is not finite. */
  void check_heat_balance(const HeatBalance &balance, const Clock &clock);
} // namespace tombolo
