// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The artificial viscosity and the artificial stress of particle parts that have them
   * (PairTerms), at the positions of t_n and the velocities of t_{n-1/2}. What each takes is an
   * artificial energy, `pair viscosity` and `artificial stress`. In scenes with heat what the
   * viscosity takes heats the particles: half of a pair each, by the velocities of t_{n-1/2} over
   * Δt_n.
   *
   * The estimate of the step sees the viscosity of all pairs.
   */
  template <int dim>
  class PairForces : public Process<dim>
  {
  public:
    explicit PairForces(const Model<dim> &model);

    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void linearize(Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;

    /** At the end of the run, where inertia is scaled, material has flowed and the viscosity has
     * taken more than 5 % of the plastic work. */
    std::vector<std::string> warnings(const Model<dim> &model, const Clock &clock,
                                      typename Process<dim>::Occasion occasion) override;

  private:
    const Model<dim> &model;
    Action *viscosity = nullptr, *stress = nullptr; // null: no part has it
    HeatAction *heat = nullptr;                     // null where nothing heats
    std::vector<std::vector<double>> power;         // of the viscosity, by particle part and row
    NodalVector applied;                            // buffer of linearize()
  };
} // namespace tombolo
