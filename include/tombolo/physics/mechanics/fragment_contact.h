// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /** Contact between fragments of particle parts: bodies that no chain of bonds connects push each
   * other away, and rub and conduct where the part asks for it. What it stores and dissipates
   * stands among the energies of the parts; what heats is kept here for the thermal step. */
  template <int dim>
  class FragmentContact : public Process<dim>
  {
  public:
    void add_forces(Model<dim> &model, const Clock &clock, const NodalVector &force) override;
    void model_changed(Model<dim> &model) override;
    double stable_fraction(double stable_step) const override;
    bool heats() const override;
    void add_heat(Model<dim> &model, double begin, double end, NodalVector &heat) override;
    void add_pending_heat(NodalVector &heat) const override;
    void account_heat(EnergyAccounts &accounts) const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;
    void report(const Model<dim> &model, TimeTable &table) const override;
    void summarize(const Model<dim> &model, const TimeTable &table, Json &summary) const override;

    explicit FragmentContact(const Model<dim> &model);

  private:
    const Model<dim> &model;
    unsigned long revision_of_cells;
    bool rubs;                // some part does, or conducts
    NodalVector pending_heat; // scalar; empty where nothing heats
    NodalVector other_heat;   // what other processes have not given yet
    Action &forces;
  };
} // namespace tombolo
