// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/condition_accounts.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/output/history.h>

#include <algorithm>
#include <string>

namespace tombolo
{
  template <int dim>
  ConditionAccounts<dim>::ConditionAccounts(const Model<dim> &model,
                                            const bool of_prescribed_motion)
      : model(model), of_prescribed_motion(of_prescribed_motion)
  {
    for (const MechanicalCondition<dim> &condition : model.conditions->all())
      accounts.push_back({prescribes(condition.type) == of_prescribed_motion, {}, 0.});
  }

  template <int dim>
  std::vector<std::array<double, 4>> ConditionAccounts<dim>::displacements() const
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

  template <int dim>
  std::vector<ConditionBalance> ConditionAccounts<dim>::balances() const
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
      const double *const of_condition = sums.data() + n_sums * c;
      ConditionBalance balance;
      balance.name = model.conditions->all()[c].name;
      balance.prescribes_motion = of_prescribed_motion;
      balance.time_of_impulse = time_of_impulse;
      balance.work = of_condition[6];
      balance.n_nodes = of_condition[10];
      std::copy_n(of_condition, 3, balance.impulse.begin());
      std::copy_n(of_condition + 3, 3, balance.angular_impulse.begin());
      for (unsigned int d = 0; d < 3 && balance.n_nodes > 0.; ++d)
        balance.displacement[d] = of_condition[7 + d] / balance.n_nodes;
      result.push_back(balance);
    }
    return result;
  }

  template <int dim>
  void ConditionAccounts<dim>::list(Records &records)
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

  template class ConditionAccounts<2>;
  template class ConditionAccounts<3>;

  template <int dim>
  void add_condition_columns(const std::vector<ConditionBalance> &conditions,
                             BalanceHistory<dim> &row)
  {
    for (const ConditionBalance &now : conditions)
    {
      row.begin_item(now);
      row.add_impulses();
      row.add("work", "M L^2/T^2", now.work);
      if (now.prescribes_motion)
        row.add("mean displacement", "L", now.displacement);
      row.summarize("work", now.work);
    }
  }

  template void add_condition_columns(const std::vector<ConditionBalance> &, BalanceHistory<2> &);
  template void add_condition_columns(const std::vector<ConditionBalance> &, BalanceHistory<3> &);

  namespace
  {
    /**
     * What holds, drives and loads the bodies: `conditions.csv`, with the mean force and the mean
     * moment on the bodies since the row before, the impulse and the work since the start of each
     * mechanical condition; of those that prescribe motion also the mean displacement of their
     * nodes. Those come first, then loads, each in the order of `Conditions`. Moments are about the
     * entry `Moments about`. Impulses are those until t_{n-1/2}, as the momenta of
     * `statistics.csv`.
     */
    const HistoryRegistration of_conditions(
        {condition_history, "conditions.csv",
         "Forces, moments, impulses and works of mechanical conditions, displacements of those "
         "that "
         "prescribe motion (conditions.csv); in every scene that has such.",
         false, true, "conditions"},
        3, "conditions of mechanics",
        [](const Section &output)
        {
          const Parameters &parameters = output.all();
          for (const std::string &name : section_names(parameters, "Conditions"))
          {
            std::string type;
            parameters.attempt([&]
                               { type = parameters.section("Condition: " + name).get("Type"); });
            for (const char *const known : {"traction", "pressure", "body force", "gravity",
                                            "velocity", "displacement", "clamp"})
              if (type == known)
                return true;
          }
          return false;
        });
  } // namespace
} // namespace tombolo
