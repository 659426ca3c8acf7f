// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /**
   * XSPH of particle parts that have it (PairTerms): after the motion of a step positions are moved
   * further, by Δt times ε Σ_j m_j W_ij/ρ (v_j - v_i). Velocities, and the stresses that follow
   * from them, do not know it, so that no energy is in it; the work of the nodal forces on what it
   * adds to the motion is the column `XSPH work`, which is in no balance. Prescribed components,
   * nodes of elements, what is neither, and nodes on which a rigid surface acts stay where they
   * are. Springs of contacts do know positions: their work on what moves others, -½ (f_n + f_{n+1})
   * · Δx, is what their energy changes by, and the energy `XSPH in contacts` is its opposite.
   */
  template <int dim>
  class Xsph : public Process<dim>
  {
  public:
    Xsph()
    {
      Records &all = this->records.group("XSPH");
      all.sums("work", work, in_contacts);
      all.nodal("moved", dim, moved);
      this->roles.rest = ProcessRole::is_idle;
      this->roles.divided_cells = ProcessRole::is_refused;
    }

    void model_changed(Model<dim> &model) override;
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    void report(const Model<dim> &model, TimeTable &table) const override;

  private:
    NodalVector mass;        // of particles of parts with XSPH, scalar, owned values [M]
    NodalVector momentum;    // that they exchange
    NodalVector other_force; // at t_n, before contacts [M L/T^2]
    NodalVector moved;       // by the last after_motion() [L]
    double work = 0;         // this rank's share
    double in_contacts = 0;  // this rank's share
  };
} // namespace tombolo
