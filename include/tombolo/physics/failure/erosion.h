// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/model/process.h>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
  /** What has left the bodies with the cells that were removed; this rank's share. */
  struct ErosionLoss
  {
    double n_cells = 0;
    double mass = 0; ///< [M]
    /** Kinetic, elastic and of hourglass stiffness; what was dissipated before stays where it is
     * accounted for [M L^2/T^2]. */
    double energy = 0;
    std::array<double, 3> momentum{};         ///< [M L/T]
    std::array<double, 3> angular_momentum{}; ///< [M L^2/T]
  };

  /**
   * Element erosion: before the forces at t_n, cells that fulfil the criterion of their part are
   * removed with their mass, momentum, energy and heat. Nodes that lose all their cells stay where
   * they are.
   */
  template <int dim>
  class Erosion : public Process<dim>
  {
  public:
    explicit Erosion(Model<dim> &model);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      ModelChange change;
      change.cells = erode(model, clock);
      return change;
    }

    void model_changed(const Model<dim> &model) override;

    void constrain_acceleration(const Model<dim> &, const Clock &, NodalState &state) override
    {
      for (const unsigned int node : massless)
        std::fill_n(state.acceleration.node(node), node_stride, 0.);
    }

    /** Removes the cells that fulfil their criterion. Returns whether there were any on any rank.
     * Collective. */
    bool erode(Model<dim> &model, const Clock &clock);

    /** Since the start, on this rank. */
    const ErosionLoss &loss() const
    {
      return lost;
    }

    /** Owned nodes all of whose cells were removed. */
    const std::vector<unsigned int> &massless_nodes() const
    {
      return massless;
    }

    /** Over all ranks. Collective. */
    unsigned long n_removed_cells() const;

  private:
    void remove_faces(Model<dim> &model) const;
    /** Takes the momentum and the kinetic energy of the mass that nodes have lost, and its heat. */
    void lose_mass(Model<dim> &model, const NodalVector &old_mass, const NodalVector &old_body_mass,
                   double pending_heat);
    /** Sums over all ranks. Collective. */
    ErosionLoss total_loss() const;

    MPI_Comm communicator;
    std::vector<ErodingCells<dim> *> parts;
    ErosionLoss lost;
    std::vector<unsigned int> massless;
  };
} // namespace tombolo
