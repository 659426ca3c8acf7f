// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/boundary/limited_function.h>
#include <tombolo/model/process.h>

#include <vector>

namespace tombolo
{
  /**
   * Damping in proportion to the mass, by the section `Damping`: the nodal force -α m v, with the
   * velocity v in the middle of Δt_n, so that the stable step is that without damping. It is a
   * force from outside, as of a fluid at rest: its impulse counts as one, and what it takes is
   * `mass damping`. Where the motion is not that of the node alone, prescribed or of a rigid part,
   * v is that of half a step before.
   */
  template <int dim>
  class Damping : public Process<dim>
  {
  public:
    /** @p rate is α, a function of time [1/T]. */
    explicit Damping(LimitedFunction<dim> rate);

    void model_changed(Model<dim> &model) override;
    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;

  private:
    LimitedFunction<dim> rate;
    std::vector<bool> is_rigid; ///< owned nodes; empty without rigid parts
    Action &damping;
  };
} // namespace tombolo
