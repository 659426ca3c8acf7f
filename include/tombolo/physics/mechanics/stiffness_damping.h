// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /**
   * Damping in proportion to the stiffness, by the section `Damping`: the nodal force -β K v with
   * the elastic stiffness K of all parts at the present positions and the velocity v of t_{n-1/2}.
   * A vibration of the angular frequency ω loses energy with the damping ratio β ω/2. It is an
   * internal force: rigid motion is not damped. What it takes is `stiffness damping`.
   *
   * As the force is that of a velocity half a step old, the stable step is shorter: h (√(1 + ξ²) -
   * ξ) with ξ = β/h, where h is the limit without it. The spectral estimate sees the operator
   * itself.
   */
  template <int dim>
  class StiffnessDamping : public Process<dim>
  {
  public:
    /** @p factor is β [T]. */
    explicit StiffnessDamping(double factor);

    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void linearize(Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override;

  private:
    /** @p result := K @p velocity, whose ghosts are current. Collective. */
    void apply_stiffness(const Model<dim> &model, const NodalVector &velocity, NodalVector &result);

    double factor;
    NodalVector stiffness_force; ///< buffer of linearize()
    Action &damping;
  };
} // namespace tombolo
