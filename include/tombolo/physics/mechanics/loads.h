// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/at_rest.h>
#include <tombolo/model/follows_divisions.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/condition_accounts.h>
#include <tombolo/physics/mechanics/load_works.h>

#include <array>
#include <vector>

namespace tombolo
{
  template <int dim>
  class MechanicalConditions;

  /**
   * Tractions, pressures and body forces. They act at positions, which move with Φ: the nodal force
   * is Φᵀ times them. The work of the step from t_{n-1} to t_n is that of the loads at both ends on
   * v_{n-1/2}.
   */
  template <int dim>
  class Loads : public Process<dim>, public FollowsDivisions<dim>, public AtRest
  {
  public:
    explicit Loads(const Model<dim> &model);

    void prepare_change(Model<dim> &model) override;
    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, NodalVector &force) override;
    std::string failure() const override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    void show(OutputView<dim> &view) const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

    /** Forces at positions at t_n, and what they are as nodal forces [M L/T^2]. */
    const NodalVector &at_positions() const;
    const NodalVector &nodal_force() const;

  private:
    using Vector = std::array<double, 3>;

    /** The velocity of t_{n-1/2} where loads act, at owned nodes. Collective. */
    const NodalVector &velocity_at_places(const Model<dim> &model);

    const MechanicalConditions<dim> &conditions;
    NodalVector loads, load_force;
    NodalVector places;              ///< where loads act, Φ x; only where there are particles
    std::vector<LoadSum> resultants; ///< of `loads`, by number of the condition
    ConditionAccounts<dim> of_conditions;
    LoadWorks<dim> works;         ///< of the single loads
    NodalVector place_velocities; ///< Φ v; only where there are particles and several loads
    double work = 0;              ///< this rank's share [M L^2/T^2]
    std::vector<Vector> previous_impulse; ///< Δt_{n-1} f_{n-1} at touched nodes
    unsigned long revision_of_stencils = 0;
    bool first_half_is_booked = false; ///< of the step in progress; never between two steps
  };
} // namespace tombolo
