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
   * nodes of elements, what is neither, and nodes on which a rigid surface acts stay where they are:
   * the energy of its springs follows from the position, and would come from nowhere.
   */
  template <int dim>
  class Xsph : public Process<dim>
  {
  public:
    void model_changed(Model<dim> &model) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    void report(const Model<dim> &model, TimeTable &table) const override;
    std::size_t memory_consumption() const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;

  private:
    NodalVector mass;     // of particles of parts with XSPH, scalar, owned values [M]
    NodalVector momentum; // that they exchange
    double work = 0;      // this rank's share
  };
} // namespace tombolo
