// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/condition_accounts.h>

#include <vector>

namespace tombolo
{
  template <int dim>
  class MechanicalConditions;

  /**
   * Tractions, pressures and body forces. They act at positions, which move with Φ: the nodal force
   * is Φᵀ times them. Where there are several, the work of a single one is that of its forces f at
   * positions on their velocity Φ v: what all do together is that of Φᵀ f on v.
   */
  template <int dim>
  class Loads : public Process<dim>
  {
  public:
    explicit Loads(const Model<dim> &model);

    void model_changed(const Model<dim> &model) override;
    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void after_acceleration(const Model<dim> &model, const Clock &clock) override;

    /** The forces of all loads. */
    const Action &action() const
    {
      return loads;
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
    std::vector<ConditionBalance> balances() const;

    /** Adds what @p add(load, velocity where it acts, work) finds to the work of each load among
     * several. Collective. */
    template <typename Add>
    void add_works(const Model<dim> &model, const Add &add);

    /** The velocity of t_{n-1/2} where loads act, at owned nodes. Collective. */
    const NodalVector &velocity_at_places(const Model<dim> &model);

    const MechanicalConditions<dim> &conditions;
    Action &loads;
    std::vector<unsigned int> loaded_nodes; ///< owned, ascending
    NodalVector places;              ///< where loads act, Φ x; only where there are particles
    std::vector<LoadSum> resultants; ///< of `loads`, by number of the condition
    ConditionAccounts<dim> of_conditions;
    std::vector<SingleLoad> single; ///< where there are several; else empty
    NodalVector place_velocities;   ///< Φ v; only where there are particles and several loads
  };
} // namespace tombolo
