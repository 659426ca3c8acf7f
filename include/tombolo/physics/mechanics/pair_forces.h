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

    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void apply_viscosity(const Model<dim> &model, const NodalVector &velocity, double factor,
                         NodalVector &force) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    bool heats() const override;
    void add_heat(Model<dim> &model, double begin, double end, NodalVector &heat) override;
    void add_pending_heat(NodalVector &heat) const override;
    void account_heat(EnergyAccounts &accounts) const override;
    std::size_t memory_consumption() const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

    /** A warning where inertia is scaled, material has flowed and the viscosity has taken more than
     * 5 % of the plastic work, for the end of the run; empty otherwise. The same on all ranks.
     * Collective. */
    std::string warning() const;

  private:
    const Model<dim> &model;
    Action *viscosity = nullptr, *stress = nullptr; // null: no part has it
    std::vector<std::vector<double>> power;         // of the viscosity, by particle part and row
    NodalVector pending_heat;                       // scalar; empty where nothing heats
    NodalVector applied;                            // buffer of apply_viscosity()
    double heat_given = 0;                          // this rank's share
  };
} // namespace tombolo
