// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/failure/momentum_redistribution.h>

#include <functional>

namespace tombolo
{
  /**
   * Bonds between particles that break, and particles that are isolated by it. The particle parts
   * break their bonds where they renew their rows; this process hands the momentum and the heat of
   * isolated particles to those that they leave (MomentumRedistribution), and counts.
   */
  template <int dim>
  class BondFailureProcess : public Process<dim>
  {
  public:
    explicit BondFailureProcess(Model<dim> &model);

    /** Over parts and ranks; the criterion of the first part that has one. Collective. */
    static BondCounts bond_counts(const Model<dim> &model);

  private:
    MomentumRedistribution<dim> redistribution;
  };
} // namespace tombolo
