// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /**
   * Neighbourhoods and rows of particle parts, renewed where their criterion asks for it.
   *
   * Where rows change between t_{n-1} and t_n, the forces of before work on the first half of the
   * step, and the points that advance over the whole of it are those of after. The difference,
   * ½ Δt (P_before - P_after) with the powers P of the stresses at t_{n-1}, is booked: as failure
   * dissipation where bonds break, else as that of the renewal.
   */
  template <int dim>
  class StencilRenewal : public Process<dim>
  {
  public:
    /** @p breaks: whether bonds can break; @p renews: whether kernels are renewed now and then.
     * Where they are renewed in every step alone, nothing is booked: it would take two more
     * evaluations of the forces. */
    StencilRenewal(bool breaks, bool renews);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override;
    void prepare_change(Model<dim> &model) override;
    void model_changed(Model<dim> &model) override;
    void account(EnergyAccounts &accounts) const override;
    void report(const Model<dim> &model, TimeTable &table) const override;

  private:
    /** internal_power() where nodes were a time `back` ago. Collective. */
    double power_back(Model<dim> &model) const;
    /** Over all ranks; zero where none can break. Collective. */
    double n_broken_bonds(const Model<dim> &model) const;

    bool breaks, renews;
    double step = 0;        ///< that led to the renewal in progress; zero without one [T]
    bool is_booked = false; ///< that renewal
    double back = 0;  ///< zero, or the step where a particle is inside out now and is isolated [T]
    double power = 0; ///< before it, this rank's share [M L^2/T^3]
    double n_broken = 0; ///< before it
    double taken_by_breaks = 0, taken_by_renewals = 0;
  };
} // namespace tombolo
