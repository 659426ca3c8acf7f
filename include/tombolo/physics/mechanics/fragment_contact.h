// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <vector>

namespace tombolo
{
  /** Contact between fragments of particle parts: bodies that no chain of bonds connects push each
   * other away. What it stores and dissipates stands among the energies of the parts. */
  template <int dim>
  class FragmentContact : public Process<dim>
  {
  public:
    void add_forces(Model<dim> &model, const Clock &clock, NodalVector &force) override;
    double stable_fraction(double stable_step) const override;
    void report(const Model<dim> &model, TimeTable &table) const override;
    void summarize(const Model<dim> &model, const TimeTable &table, Json &summary) const override;

    explicit FragmentContact(const Model<dim> &model);

  private:
    const Model<dim> &model;
    unsigned long revision_of_cells;
    NodalVector loads;       // at positions [M L/T^2]
    NodalVector nodal_force; // Φᵀ loads
    std::vector<unsigned int> loaded_nodes;
  };
} // namespace tombolo
