// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/condition_accounts.h>
#include <tombolo/state/dependent_nodes.h>

#include <functional>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Tractions, pressures and body forces. They act at positions, which move with Φ: the nodal force
   * is Φᵀ times them. Where there are several, the work of a single one is that of its forces f at
   * positions on their velocity Φ v: the work of all together is that of Φᵀ f on v.
   */
  template <int dim>
  class Loads : public Process<dim>
  {
  public:
    explicit Loads(const Model<dim> &model)
        : conditions(*model.conditions), loads(this->actions.add("loads", ActsAt::loads)),
          accounts(model, false)
    {
      loads.books("external work", EnergyKind::external).comes_from_outside().stays_on_rank();
      model.signals.change.connect(
          [this, &model]
          {
            add_works(model, [](SingleLoad &load, const NodalVector &velocity, double &work)
                      { load.work.begin_change(velocity, work); });
          });
      this->observed.history(condition_history, [this](BalanceHistory<dim> &row)
                             { add_condition_columns(balances(), row); });
      for (unsigned int c = 0; c < conditions.all().size(); ++c)
        if (!prescribes(conditions.all()[c].type))
          single.push_back({c, {}, {}});
      if (single.size() == 1)
        single.clear();
      Records &all = this->records.group("loads");
      accounts.list(all);
      for (SingleLoad &load : single)
        load.work.list("previous impulse of " + std::to_string(load.condition), all);
    }

    void model_changed(const Model<dim> &model) override
    {
      loaded_nodes =
          with_nodes_depended_on(model.state.partition(), conditions.loaded_nodes(model.state));
      if (model.bridge->has_particles())
        load_positions.reinit(model.state.partition(), model.state.position.quantity());
    }

    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &) override
    {
      const bool has_particles = model.bridge->has_particles();
      if (has_particles)
        model.bridge->load_transfer().field_at_loads(loaded_nodes, model.state.position,
                                                     load_positions);
      std::function<void(unsigned int, const NodalVector &)> store_alone;
      if (!single.empty())
        store_alone = [this](const unsigned int condition, const NodalVector &alone)
        {
          for (SingleLoad &load : single)
            if (load.condition == condition)
              extract_forces(alone, loaded_nodes, load.at_positions);
        };
      for (SingleLoad &load : single)
        load.at_positions.clear();
      loads.touched_nodes() = loaded_nodes;
      conditions.compute_loads(
          model.state, clock.time, has_particles ? load_positions : model.state.position,
          loads.at_touched_nodes(), resultants, model.body_mass(), store_alone);
    }

    void after_acceleration(const Model<dim> &model, const Clock &clock) override
    {
      accounts.begin_step(clock.velocity_time());
      accounts.add_loads(resultants, clock.velocity_step());
      add_works(model, [&](SingleLoad &load, const NodalVector &velocity, double &work)
                { load.work.complete_step(load.at_positions, velocity, clock, work); });
    }

    /** The forces of all loads. */
    const Action &action() const
    {
      return loads;
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &, const Model<dim> &model)
    {
      if (!model.has_mechanics || !model.conditions->has_loads())
        return nullptr;
      return std::make_unique<Loads>(model);
    }

  private:
    /** A load among several. */
    struct SingleLoad
    {
      unsigned int condition;
      NodalForces at_positions; ///< at t_n
      StepWork work;
    };

    /** Collective. */
    std::vector<ConditionBalance> balances() const
    {
      std::vector<ConditionBalance> result = accounts.balances();
      if (single.empty()) // one load, which has done all the work
        result.front().work = ordered_sum(loads.work(), loads.given().partition()->communicator());
      return result;
    }

    /** Adds the work by @p add(load, velocity where it acts, work) to that of each load among
     * several. Collective. */
    template <typename Add>
    void add_works(const Model<dim> &model, const Add &add)
    {
      if (single.empty())
        return;
      const NodalVector &velocity = velocity_at_loads(model);
      for (SingleLoad &load : single)
      {
        double work = 0;
        add(load, velocity, work);
        accounts[load.condition].work += work;
      }
    }

    /** The velocity of t_{n-1/2} where loads act, at owned nodes. Collective. */
    const NodalVector &velocity_at_loads(const Model<dim> &model)
    {
      if (!model.bridge->has_particles())
        return model.state.velocity;
      load_velocities.fit_to(model.state.partition());
      model.bridge->load_transfer().field_at_loads(loaded_nodes, model.state.velocity,
                                                   load_velocities);
      return load_velocities;
    }

    const MechanicalConditions<dim> &conditions;
    Action &loads;
    std::vector<unsigned int> loaded_nodes; ///< owned, ascending
    NodalVector load_positions;      ///< where loads act, Φ x; only where there are particles
    std::vector<LoadSum> resultants; ///< of `loads`, by number of the condition
    ConditionAccounts<dim> accounts;
    std::vector<SingleLoad> single; ///< where there are several; else empty
    NodalVector load_velocities;    ///< Φ v; only where there are particles and several loads
  };
} // namespace tombolo
