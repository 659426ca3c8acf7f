// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/bridge.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** Adds the nodal forces of @p loads at the positions of @p nodes to @p force
   * (LoadTransfer::add_force_at_positions()); the nodes are owned and may come in any order and
   * more than once. Then sets these loads to zero for the next step. Afterwards @p nodes are
   * ascending, each once. Ghosts of the force are not collected. */
  inline void spread_loads(Bridge &bridge, std::vector<unsigned int> &nodes, NodalVector &loads,
                           NodalVector &force)
  {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    bridge.load_transfer().add_force_at_positions(nodes, loads, force);
    for (const unsigned int node : nodes)
      std::fill_n(loads.node(node), node_stride, 0.);
  }
} // namespace tombolo
