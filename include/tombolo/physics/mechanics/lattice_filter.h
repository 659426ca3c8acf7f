// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/bridge.h>
#include <tombolo/model/process.h>

namespace tombolo
{
  /** c/h of the fastest and finest particle part [1/T]: the rate of the lattice filter. Collective.
   */
  template <int dim>
  double lattice_filter_rate(const Model<dim> &model);

  /**
   * Removes waves that alternate between neighbouring particles (Bridge::filter()) every few steps,
   * from the mean of the velocities before and after t_n. What the scheme conserves is
   * ½ v_n·M̂ v_n - Δt²/8 a·M a + U with v_n = (v⁻ + v⁺)/2: a filter of v⁺ would change it by a term
   * of either sign, which, taken at one phase of a short wave every few steps, can make it grow.
   */
  template <int dim>
  class LatticeFilter : public Process<dim>
  {
  public:
    explicit LatticeFilter(const LatticeFilterSettings &settings);

    void model_changed(Model<dim> &model) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

  private:
    bool is_due(const Clock &clock) const;

    LatticeFilterSettings settings;
    NodalVector half_kick; // v̂ at t_{n-1/2}, then (v̂ at t_{n+1/2} - v̂ at t_{n-1/2}) / 2
    double time_since_filter = 0;
    double dissipated = 0; ///< of all ranks [M L^2/T^2]
  };
} // namespace tombolo
