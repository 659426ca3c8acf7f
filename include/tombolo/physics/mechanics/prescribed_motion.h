// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/condition_accounts.h>

#include <array>
#include <vector>

namespace tombolo
{
  template <int dim>
  class MechanicalConditions;

  /**
   * Components of the motion that conditions prescribe: their acceleration, and work and impulse of
   * the reactions m a - F that hold them. The work of the step from t_{n-1} to t_n is that of the
   * reactions at both ends on v_{n-1/2}. Impulse and work of each condition are kept besides the
   * sums. With affine smoothing, whose angular momentum is that about x̂, the reactions have a
   * further moment: ConstrainedParticles::find_moments().
   */
  template <int dim>
  class PrescribedMotion : public Process<dim>
  {
  public:
    explicit PrescribedMotion(const Model<dim> &model);

    void prepare_change(Model<dim> &model) override;
    std::string failure() const override;
    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    void show(OutputView<dim> &view) const override;

  private:
    using Vector = std::array<double, 3>;

    /** What prescribed components of particles add to the moment of the reactions. Collective. */
    void add_moments(Model<dim> &model, double velocity_step);
    void serialize_offsets(StateArchive &archive) const;

    /** m a - F of the prescribed components of an owned node [M L/T^2]. */
    Vector reaction(unsigned int node) const;

    const Model<dim> &model;
    const MechanicalConditions<dim> &conditions;
    double work = 0;                      ///< this rank's share [M L^2/T^2]
    ConditionAccounts<dim> supports;      ///< the same by condition, and impulses
    std::vector<Vector> previous_inertia; ///< Δt_{n-1} m a at constrained nodes
    std::vector<Vector> previous_force;   ///< Δt_{n-1} F at constrained nodes
  };
} // namespace tombolo
