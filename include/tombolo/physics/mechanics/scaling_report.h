// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/json.h>
#include <tombolo/model/model.h>
#include <tombolo/output/energy_ledger.h>
#include <tombolo/output/time_table.h>

#include <ostream>

namespace tombolo
{
  /** What scaled inertia is, for the audit, the statistics and the summary: only of scenes that
   * have `Model::scaling`. Added mass is that of the process that runs faster: what the factor of
   * the process does to inertia is no mass. */
  template <int dim>
  class ScalingReport
  {
  public:
    /** Sums the masses of the present. Collective. */
    explicit ScalingReport(const Model<dim> &model);

    double mass() const;       ///< the true one [M]
    double added_mass() const; ///< [M]

    /** Lines for the audit. Collective. */
    void print(std::ostream &text) const;

    /** Columns for the row in progress. */
    void add_to(TimeTable &statistics, const EnergyBalance &balance) const;

    /** For `scaling` of the summary. The ratio of energies is the largest of the rows whose
     * internal energy is at least 1 % of the largest of all rows: before, nothing has been deformed
     * that inertia could be compared with. Null if there is no such row. Collective. */
    Json summary(const TimeTable &statistics) const;

    /** Elastic and plastic: what inertia is compared with. */
    static double internal_energy(const EnergyBalance &balance);

  private:
    const Model<dim> &model;
    double true_mass = 0, inertia = 0;
  };
} // namespace tombolo
