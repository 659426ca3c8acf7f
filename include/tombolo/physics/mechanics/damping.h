// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/limited_function.h>
#include <tombolo/model/follows_divisions.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/damping_work.h>

#include <vector>

namespace tombolo
{
  /**
   * Damping in proportion to the mass, by the section `Damping`: the nodal force -α m v, with the
   * velocity v in the middle of Δt_n, so that the stable step is that without damping. It is a
   * force from outside, as of a fluid at rest: its impulse counts as one, and what it takes is
   * `mass damping`. The work of the step from t_{n-1} to t_n is that of the forces at both ends on
   * v_{n-1/2}. Where the motion is not that of the node alone, prescribed or of a rigid part, v is
   * that of half a step before.
   */
  template <int dim>
  class Damping : public Process<dim>, public FollowsDivisions<dim>
  {
  public:
    /** @p rate is α, a function of time [1/T]. */
    explicit Damping(LimitedFunction<dim> rate);

    void prepare_change(Model<dim> &model) override;
    void model_changed(Model<dim> &model) override;
    /** Adds the force, and what it does to the acceleration, where no motion is prescribed. */
    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    std::size_t memory_consumption() const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

  private:
    using Vector = typename DampingWork<dim>::Vector;

    LimitedFunction<dim> rate;
    std::vector<bool> is_rigid; ///< owned nodes; empty without rigid parts
    std::vector<Vector> force;  ///< at t_n, of owned nodes [M L/T^2]
    DampingWork<dim> work;
  };
} // namespace tombolo
