// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/energy_accounts.h>

#include <array>

namespace tombolo
{
  class Records;
  template <int dim>
  class Model;

  /** Energies and momenta at one time; sums over all ranks. */
  struct EnergyBalance
  {
    /** By name, that of parts and processes after "kinetic energy", ½ v̂_{n-1/2} · M̂ v̂_{n+1/2}. */
    EnergyAccounts energies;
    double smoothed_kinetic = 0; ///< ½ v · M v at t_{n-1/2} [M L^2/T^2]
    double total = 0;            ///< all energies but external ones
    double external = 0;         ///< added since the start
    double initial_total = 0;
    /** (total - external - initial total) / the largest initial total + external so far. */
    double error = 0;
    double short_wave_share = 0;      ///< of the kinetic energy of v̂ that S removes
    std::array<double, 3> momentum{}; ///< Σ m̂ v̂_{n-1/2} [M L/T]
    std::array<double, 3> impulse{};  ///< of loads, reactions and added mass since the start
    std::array<double, 3> angular_momentum{}; ///< Σ x̂_n × m̂ v̂_{n-1/2} [M L^2/T]
    std::array<double, 3> angular_impulse{};
    double momentum_scale = 0;         ///< the largest Σ m̂ |v̂| so far
    double angular_momentum_scale = 0; ///< the largest Σ |x - x̄| m̂ |v̂| so far
    /** |momentum + removed momentum - initial - impulse| / scale. Only of components that the body
     * conserves by itself: reactions of planes of symmetry are no impulses here. */
    double momentum_drift = 0;
    double angular_momentum_drift = 0;
  };

  /**
   * The balance of energy and momentum (doc/method.md, section 14). Internal energy comes from the
   * stored state of the material points, never from Δt F · v, so that the balance is a test and not
   * an identity. Parts and processes account for the energies that they store, dissipate and add
   * (EnergyAccounts).
   */
  class EnergyLedger
  {
  public:
    /** The balance at t_n, before the motion. An error of at most @p unresolved [M L^2/T^2], the
     * uncertainty of works, counts as zero. Collective. */
    template <int dim>
    EnergyBalance balance(const Model<dim> &model, const Clock &clock, double unresolved = 0.);

    /** Lists the state between the steps, with the relative numbers of the @p last balance, for the
     * summary of a run that ends before the next. */
    void list(Records &records, EnergyBalance &last);

  private:
    /** Sets drifts and scales from momenta and impulses. */
    template <int dim>
    void find_drifts(const Model<dim> &model, EnergyBalance &result);

    bool has_start = false;
    double initial_total = 0;
    double largest_input = 0;
    double largest_momentum = 0;
    double largest_angular_momentum = 0;
    std::array<double, 3> initial_momentum{};
    std::array<double, 3> initial_angular_momentum{};
  };
} // namespace tombolo
