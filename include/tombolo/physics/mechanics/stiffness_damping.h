// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/follows_divisions.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/damping_work.h>

#include <vector>

namespace tombolo
{
  /**
   * Damping in proportion to the stiffness, by the section `Damping`: the nodal force -β K v with
   * the elastic stiffness K of all parts at the present positions and the velocity v of t_{n-1/2}.
   * A vibration of the angular frequency ω loses energy with the damping ratio β ω/2. It is an
   * internal force: rigid motion is not damped. What it takes is `stiffness damping`. The work of
   * the step from t_{n-1} to t_n is that of the forces at both ends on v_{n-1/2}.
   *
   * As the force is that of a velocity half a step old, the stable step is shorter: h (√(1 + ξ²) -
   * ξ) with ξ = β/h, where h is the limit without it. The spectral estimate sees the operator
   * itself.
   */
  template <int dim>
  class StiffnessDamping : public Process<dim>, public FollowsDivisions<dim>
  {
  public:
    /** @p factor is β [T]. Where the estimate of the step does not see the force, @p
     * limits_step_itself. */
    StiffnessDamping(double factor, bool limits_step_itself);

    void prepare_change(Model<dim> &model) override;
    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, NodalVector &force) override;
    void apply_viscosity(const Model<dim> &model, const NodalVector &velocity, double factor,
                         NodalVector &force) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    double stable_fraction(double stable_step) const override;
    void account(EnergyAccounts &accounts) const override;
    std::size_t memory_consumption() const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

  private:
    using Vector = typename DampingWork<dim>::Vector;

    /** @p result := K @p velocity, whose ghosts are current. Collective. */
    void apply_stiffness(const Model<dim> &model, const NodalVector &velocity, NodalVector &result);

    double factor;
    bool limits_step_itself;
    NodalVector stiffness_force;
    std::vector<Vector> force; ///< at t_n, of owned nodes [M L/T^2]
    DampingWork<dim> work;
  };
} // namespace tombolo
