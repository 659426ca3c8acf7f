// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/mass_split.h>

#include <vector>

namespace tombolo
{
  /** Nodal forces of loads, forces that act at positions of single nodes: Φᵀ of them where
   * positions move with Φ, the loads themselves where positions move with the nodal velocities. */
  class LoadTransfer
  {
  public:
    /** @p split must outlive this; @p direct says that positions move with the nodal velocities. */
    LoadTransfer(const MassSplit &split, bool direct);

    /** To be called when the split is another one. */
    void forget_rows();

    /** Sets the owned nodes at which loads can be different from zero. To be called again when the
     * split is another one. Collective. */
    void set_loaded_nodes(const std::vector<unsigned int> &nodes);

    /** @p force = Φᵀ @p loads. Touches only touched_nodes(); ghosts are collected. Collective. */
    void force_of_loads(const NodalVector &loads, NodalVector &force) const;

    /** Adds Φᵀ of the loads at these owned nodes to @p force, for loads whose nodes change from
     * step to step. Ghosts are not collected. */
    void add_force_of_loads(const std::vector<unsigned int> &nodes, const NodalVector &loads,
                            NodalVector &force);

    /** Local nodes where force_of_loads() can be different from zero, ascending. */
    const std::vector<unsigned int> &touched_nodes() const;

  private:
    static constexpr unsigned int is_nowhere = static_cast<unsigned int>(-1);
    void find_positions_in_lists();
    void find_touched_nodes();

    const MassSplit &split;
    bool direct;
    std::vector<std::size_t> loaded_own;                // indices into the own nodes
    std::vector<std::vector<unsigned int>> loaded_rows; // by part
    std::vector<unsigned int> touched;
    // By owned node, for add_force_of_loads(); made when asked for.
    std::vector<unsigned int> position_in_own;
    std::vector<std::vector<unsigned int>> row_of_node; // by part
  };
} // namespace tombolo
