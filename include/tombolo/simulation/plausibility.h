// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/state/records.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * What a run shows that can hardly be: the worst of all rows of the table over time, each as a
   * sentence with place and number.
   *
   * - a material point that is hotter than the melting temperature of its material, if it has one;
   * - a kinetic energy that is nearly all in the lattice mode, with velocities that alternate from
   *   particle to particle, where it is not negligible;
   * - an angular momentum that drifts though nothing acts on the body from outside.
   */
  class Plausibility
  {
  public:
    Plausibility();

    /** Looks at a row. Collective. */
    template <int dim>
    void look(const Model<dim> &model, const EnergyBalance &balance, double time);

    /** The sentences; the same on all ranks. */
    std::vector<std::string> findings() const;

    Records records;

  private:
    struct Worst
    {
      double value = 0; ///< zero: nothing
      std::string sentence;
    };

    template <int dim>
    void look_for_melt(const Model<dim> &model, double time);
    template <int dim>
    void look_for_lattice_mode(const Model<dim> &model, const EnergyBalance &balance, double time);
    void look_for_drift(const EnergyBalance &balance, double time);

    Worst melt, lattice_mode, angular_momentum;
  };
} // namespace tombolo
