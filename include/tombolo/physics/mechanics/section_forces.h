// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/impulse_account.h>
#include <tombolo/model/process.h>
#include <tombolo/output/section_balance.h>
#include <tombolo/physics/mechanics/body_section.h>

#include <vector>

namespace tombolo
{
  /** Observes what passes through the sections of the scene (BodySection); it changes nothing. It
   * comes after the viscosity of surfaces and before all that acts from outside, so that the nodal
   * forces which it sees are those of the material alone. */
  template <int dim>
  class SectionForces : public Process<dim>
  {
  public:
    SectionForces(std::vector<BodySection<dim>> sections, const Model<dim> &model);

    void model_changed(Model<dim> &model) override;
    void part_force(std::size_t part, const NodalVector &force, bool is_added) override;
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void describe(const Model<dim> &model, std::ostream &text) const override;
    std::vector<std::string> warnings(const Model<dim> &model, const Clock &clock,
                                      typename Process<dim>::Occasion occasion) override;
    void show(OutputView<dim> &view) const override;

    /** Sums over all ranks, in the order of the sections. Collective. */
    std::vector<SectionBalance> balances() const;

    /** With this rank's share of the force at t_n. */
    const std::vector<BodySection<dim>> &sections() const;

  private:
    const Model<dim> &model;
    std::vector<BodySection<dim>> members;
    std::vector<ImpulseAccount> impulses; ///< of each, with moments about its point
    double time_of_impulse = 0;
  };
} // namespace tombolo
