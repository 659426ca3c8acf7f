// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/former_rows.h>
#include <tombolo/state/nodal_vector.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /**
   * What particles leave behind when they become debris. As a part of the body a particle moves
   * with a smoothed velocity, Φ S v̂ (with affine smoothing S v̂), and has a smoothed
   * temperature, Φ S θ̂. Debris would go on with its own v̂ and θ̂. So it gets the smoothed ones as
   * its own, and what that takes from its momentum and heat goes to the neighbours that it leaves:
   * to each in proportion to φ m of its former row, where φ is positive and no round-off, but not
   * to other debris, unless there is nothing else. Momentum and heat are conserved to round-off;
   * the difference in kinetic energy is booked as lost to failure, at the points of the particles
   * that it was taken from or given to.
   *
   * Nodes shared with elements are no debris: the bond to the elements holds. Prescribed components
   * are left alone at both ends.
   */
  template <int dim>
  class MomentumRedistribution
  {
  public:
    /** Is told by ModelSignals::rows_change of @p model. */
    explicit MomentumRedistribution(Model<dim> &model);

    /** After all parts were updated and one has changed, as long as the state has the partition in
     * force before. Collective. */
    void complete();

  private:
    /** Before the first change: the smoothed velocity of the rows as they are. */
    void prepare();
    void hand_over_velocity();
    void hand_over_heat(const NodalVector &field, NodalVector &unsmoothed, NodalVector &enthalpy);
    /** m at each local node, in the components that are not @p constrained: those of a whole body
     * also on planes of symmetry. @p mass is scalar. */
    void find_weights(const NodalVector &mass, const std::vector<std::uint8_t> &constrained);
    /** Whether any node would take component @p c of what leaving particle @p k gives. */
    bool can_give(std::size_t k, unsigned int c) const;
    /** Gives @p given, node_stride for each leaving particle, to the nodes of its row: @p received,
     * which is zero. Collective. */
    NodalVector share(const std::vector<double> &given, Quantity quantity) const;
    /** The part of component @p c that goes to entry @p entry of the row of @p k is
     * receivable(...) over its sum. */
    double receivable(std::size_t entry, unsigned int c, bool only_bonded) const;
    double sum_of_receivable(std::size_t k, unsigned int c, bool only_bonded) const;

    Model<dim> &model;
    bool is_prepared = false;
    std::vector<std::vector<unsigned int>> node_of_row; // by part; empty: not one of particles

    // While complete() works.
    LeavingParticles leaving; // of all parts; rows are owned nodes
    NodalVector is_debris;    // scalar: 1 or 0
    NodalVector weight;
  };
} // namespace tombolo
