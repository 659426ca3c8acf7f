// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/bridge.h>
#include <tombolo/model/process.h>

namespace tombolo
{
  /** v̂ ← v̂ - δ (I - ΦS)^power v̂, every `interval` steps (doc/method.md, section 9). */
  struct LatticeFilterSettings
  {
    unsigned int power = 0;    ///< 0: no filter
    double strength = 0;       ///< β in δ = β c Δt n / h
    unsigned int interval = 1; ///< n
    double rate = 0;           ///< c/h of the particle region [1/T]
  };

  /** c/h of the fastest and finest particle part [1/T]: the rate of the lattice filter. Collective.
   */
  template <int dim>
  double lattice_filter_rate(const Model<dim> &model);

  /**
   * Removes waves that alternate between neighbouring particles every few steps,
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
    /** Filters v̂ once, with δ = strength · rate · @p elapsed, at most 1. Returns the kinetic energy
     * that it took. Collective. */
    double filter(Model<dim> &model, double elapsed);

    LatticeFilterSettings settings;
    NodalVector half_kick; // v̂ at t_{n-1/2}, then (v̂ at t_{n+1/2} - v̂ at t_{n-1/2}) / 2
    NodalVector change, image;
    double time_since_filter = 0;
    double dissipated = 0; ///< of all ranks [M L^2/T^2]
  };
} // namespace tombolo
