// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/format.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/simulation/advice.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

namespace tombolo
{
  /** Whether the step is one in which the balance is checked between outputs, which takes half as
   * long as a step; @p limit is that of check_energy_balance(). */
  inline bool is_energy_check_due(const Clock &clock, const double limit)
  {
    constexpr unsigned long interval = 100;
    return limit > 0. && clock.step % interval == 0;
  }

  /** Sentences about a step that is too long for a motion, or that is not. Collective. */
  template <int dim>
  std::string judgement_of_step(const Model<dim> &model, const EnergyBalance &balance,
                                const Clock &clock, const StepSize<dim> &step_size)
  {
    const std::string cure = std::string("a smaller step (`Time step/") +
                             (step_size.is_given() ? "Fixed" : "Safety factor") + "`) helps.";
    // Such energies come from steps alone; their positions mean nothing.
    constexpr double without_bound = 1e3;
    const double put_in = std::abs(balance.initial_total + balance.external);
    if (!(std::abs(balance.total) <= without_bound * put_in))
      return "The motion is not stable: " + cure;
    // Above √3/2 of the limit the third harmonic of a mode is in step with it.
    constexpr double largest_share = 0.866;
    const double step = std::max(clock.previous_step, clock.next_step);
    const double share = step / spectral_limit(model);
    const std::string text = as_text(std::setprecision(3), "The step ", step, " is ", share,
                                     " of the limit of the spectral estimate");
    if (!(share <= largest_share))
      return "The motion is not stable: " + cure + " " + text + ".";
    // What sets in at once, such as a drive, is booked by the first steps to their size.
    constexpr unsigned int few_steps = 50;
    if (clock.step < few_steps)
      return text + ", at which motions are stable, but the run has had few of them: " + cure;
    return text + ", at which motions are stable: a smaller one hardly helps. Another "
                  "formulation may help.";
  }

  /** The accounts that make up the balance, the largest first: those below a hundredth of it are
   * left out. */
  inline std::string largest_accounts(const EnergyAccounts &energies)
  {
    const auto size_of = [](const EnergyAccounts::Account &account)
    { return std::isnan(account.value) ? HUGE_VAL : std::abs(account.value); };
    std::vector<EnergyAccounts::Account> accounts = energies.accounts();
    std::stable_sort(accounts.begin(), accounts.end(),
                     [&](const auto &a, const auto &b) { return size_of(a) > size_of(b); });
    std::ostringstream text;
    text.precision(4);
    for (const EnergyAccounts::Account &account : accounts)
      if (account.value != 0. && size_of(account) >= 0.01 * size_of(accounts[0]))
        text << (text.tellp() > 0 ? ", " : "") << account.name << " " << account.value;
    return text.str();
  }

  /** The remedy for the balance of static steps. */
  constexpr const char *judgement_at_rest =
      "Works are those of forces that change linearly over a step; where they do not, a smaller "
      "`Statics/Largest step` makes the error smaller.";

  /** Whether the energy balance is off by more than @p limit of the largest energy put in (zero: no
   * limit) and by more than the round-off of the energies, or of the smallest numbers. That of a
   * body at rest is all round-off. The same on all ranks. Collective. */
  template <int dim>
  bool is_off_balance(const Model<dim> &model, const EnergyBalance &balance, const double limit)
  {
    if (limit == 0. || std::abs(balance.error) <= limit)
      return false;
    const double put_in = balance.initial_total + balance.external;
    // Energies near the smallest numbers have no digits that could balance.
    constexpr double smallest = 1e-280;
    if (std::abs(balance.total) < smallest && std::abs(put_in) < smallest)
      return false;
    // The balance of a body at rest is all round-off.
    double speed = 0, mass = 0;
    for (const Part<dim> &part : model.parts)
      speed = std::max(speed, part.material->longitudinal_wave_speed());
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      mass += *model.bridge->mass().node(i);
    mass = dealii::Utilities::MPI::sum(mass, model.communicator);
    constexpr double round_off = 1e-20;
    return !std::isfinite(balance.total) ||
           !(std::abs(balance.total - put_in) <= round_off * mass * speed * speed);
  }

  /** Throws RunError on all ranks where is_off_balance(). The message says what helps: @p step_size
   * has chosen the steps, and none where bodies are at rest. Collective. */
  template <int dim>
  void check_energy_balance(const Model<dim> &model, const EnergyBalance &balance,
                            const Clock &clock, const double limit, const StepSize<dim> &step_size)
  {
    if (!is_off_balance(model, balance, limit))
      return;
    const double put_in = balance.initial_total + balance.external;
    throw RunError(
        as_text(std::setprecision(4), "The energy balance does not hold at time ", clock.time,
                ", step ", clock.step, ": a total energy of ", balance.total, ", where ", put_in,
                " was put in (error ", balance.error, ", allowed ", limit, "). ",
                (step_size.largest() == 0. ? judgement_at_rest
                                           : judgement_of_step(model, balance, clock, step_size)),
                " `Largest energy error` is the limit. The largest energies: ",
                largest_accounts(balance.energies), "."));
  }

  /** Throws RunError where the balance of heat is not finite. */
  inline void check_heat_balance(const HeatBalance &balance, const Clock &clock)
  {
    if (!std::isfinite(balance.error))
      throw RunError("The balance of heat is not finite at time " + std::to_string(clock.time) +
                     ": densities, heat capacities or temperatures are beyond all numbers.");
  }
} // namespace tombolo
