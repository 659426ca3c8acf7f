// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/model/impulse_account.h>

#include <array>
#include <vector>

namespace tombolo
{
  template <int dim>
  class BalanceHistory;
  template <int dim>
  class Model;

  /** The table `conditions.csv` of all mechanical conditions. */
  constexpr const char *condition_history = "condition history";

  /** What a mechanical condition, a support, a drive or a load, does to the bodies; sums over all
   * its nodes and ranks. Impulses are those until t_{n-1/2}, as the momentum; moments are about the
   * origin of coordinates. */
  struct ConditionBalance : ImpulseBalance
  {
    bool prescribes_motion = false; ///< otherwise it is a load
    double n_nodes = 0;             ///< not of loads
    /** x - X at t_n, the mean over the nodes with the same weight each; not of loads [L]. */
    std::array<double, 3> displacement{};
  };

  /** Adds the columns of conditions to their table. */
  template <int dim>
  void add_condition_columns(const std::vector<ConditionBalance> &conditions,
                             BalanceHistory<dim> &row);

  /** Impulses and works of mechanical conditions, by their number: shares of this rank since the
   * start. */
  template <int dim>
  class ConditionAccounts
  {
  public:
    /** Of those that prescribe motion, or of the loads. */
    ConditionAccounts(const Model<dim> &model, bool of_prescribed_motion);

    /** The impulses of the last step count from now on; those that follow are of the interval
     * around t_n, which began at @p time_of_impulse = t_{n-1/2}. */
    void begin_step(const double begin_of_interval)
    {
      time_of_impulse = begin_of_interval;
      for (Account &account : accounts)
        account.impulses.begin_step();
    }

    /** Of one of them. */
    struct Account
    {
      bool is_kept; ///< the others are of the other kind
      ImpulseAccount impulses;
      double work = 0;
    };
    Account &operator[](const unsigned int condition)
    {
      return accounts[condition];
    }

    /** Adds the impulses of loads over @p interval, in the step at hand. */
    void add_loads(const std::vector<LoadSum> &loads, const double interval)
    {
      for (std::size_t c = 0; c < accounts.size(); ++c)
        accounts[c].impulses.add(loads[c].force, loads[c].moment, interval);
    }

    /** In the order of the conditions. Collective. */
    std::vector<ConditionBalance> balances() const;

    /** Lists what is kept from step to step. */
    void list(Records &records);

  private:
    /** Sums of x - X over the nodes that each condition prescribes, and their number. */
    std::vector<std::array<double, 4>> displacements() const;

    const Model<dim> &model;
    bool of_prescribed_motion;
    std::vector<Account> accounts; ///< by number of the condition
    double time_of_impulse = 0;
  };
} // namespace tombolo
