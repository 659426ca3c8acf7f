// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/impulse_account.h>
#include <tombolo/model/model.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  class BalanceHistory;

  /** The table `conditions.csv` of all mechanical conditions. */
  constexpr const char *condition_history = "condition history";

  /** The effect of a mechanical condition, a support, a drive or a load, on the bodies; sums over
   * all its nodes and ranks. Impulses are those until t_{n-1/2}, as the momentum; moments are about
   * the origin of coordinates. */
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
    ConditionAccounts(const Model<dim> &model, const bool is_for_motion)
        : model(model), is_for_motion(is_for_motion)
    {
      for (const MechanicalCondition<dim> &condition : model.conditions->all())
        accounts.push_back({prescribes(condition.type) == is_for_motion, {}, 0.});
    }

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
      bool is_kept; ///< false for conditions of the other kind
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
    std::vector<ConditionBalance> balances() const
    {
      constexpr unsigned int n_sums = 11; // impulse, its moment, work, displacement, nodes
      std::vector<double> sums;
      const std::vector<std::array<double, 4>> displacement = displacements();
      for (std::size_t c = 0; c < accounts.size(); ++c)
      {
        accounts[c].impulses.append(sums);
        sums.push_back(accounts[c].work);
        sums.insert(sums.end(), displacement[c].begin(), displacement[c].end());
      }
      sums = ordered_sum(sums, model.communicator);

      std::vector<ConditionBalance> result;
      for (std::size_t c = 0; c < accounts.size(); ++c)
      {
        if (!accounts[c].is_kept)
          continue;
        const double *const condition_sums = sums.data() + n_sums * c;
        ConditionBalance balance;
        balance.name = model.conditions->all()[c].name;
        balance.prescribes_motion = is_for_motion;
        balance.time_of_impulse = time_of_impulse;
        balance.work = condition_sums[6];
        balance.n_nodes = condition_sums[10];
        std::copy_n(condition_sums, 3, balance.impulse.begin());
        std::copy_n(condition_sums + 3, 3, balance.angular_impulse.begin());
        for (unsigned int d = 0; d < 3 && balance.n_nodes > 0.; ++d)
          balance.displacement[d] = condition_sums[7 + d] / balance.n_nodes;
        result.push_back(balance);
      }
      return result;
    }

    /** Lists the state from step to step. */
    void list(Records &records)
    {
      Records &all = records.group("by condition");
      std::vector<double *> works;
      for (std::size_t c = 0; c < accounts.size(); ++c)
      {
        works.push_back(&accounts[c].work);
        accounts[c].impulses.list(all.group(std::to_string(c)));
      }
      all.sums("work", works);
      all.value("time of impulse", time_of_impulse);
    }

  private:
    /** Sums of x - X over the nodes that each condition prescribes, and their number. */
    std::vector<std::array<double, 4>> displacements() const
    {
      const MechanicalConditions<dim> &conditions = *model.conditions;
      std::vector<std::array<double, 4>> result(accounts.size(), std::array<double, 4>{});
      const std::vector<unsigned int> &nodes = conditions.constrained_nodes();
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const int c = conditions.prescribing_condition(k, d);
          bool is_new = c >= 0; // a condition can prescribe several components of a node
          for (unsigned int before = 0; before < d && is_new; ++before)
            is_new = conditions.prescribing_condition(k, before) != c;
          if (!is_new)
            continue;
          std::array<double, 4> &sum = result[static_cast<std::size_t>(c)];
          for (unsigned int e = 0; e < 3; ++e)
            sum[e] += model.state.position.node(nodes[k])[e] -
                      model.state.initial_position.node(nodes[k])[e];
          sum[3] += 1.;
        }
      return result;
    }

    const Model<dim> &model;
    bool is_for_motion;
    std::vector<Account> accounts; ///< by number of the condition
    double time_of_impulse = 0;
  };
} // namespace tombolo
