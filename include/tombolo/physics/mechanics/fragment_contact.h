// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

namespace tombolo
{
  /** Contact between fragments of particle parts: bodies that no chain of bonds connects push each
   * other away, and rub and conduct where the part asks for it. What it stores and dissipates
   * stands among the energies of the parts. */
  template <int dim>
  class FragmentContact : public Process<dim>
  {
  public:
    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &force) override;

    explicit FragmentContact(const Model<dim> &model);

  private:
    const Model<dim> &model;
    unsigned long revision_of_cells;
    bool rubs; // some part does, or conducts
    Action &forces;
    HeatAction *heat = nullptr; // null where nothing heats
  };
} // namespace tombolo
