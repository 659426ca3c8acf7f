// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>
#include <tombolo/mesh/part_cells.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /** Numbers of this rank's cells of a part, in the order of active cells, that depend on nothing
   * but the coarse cell and the place in it: the same for any number of ranks. */
  template <int dim>
  std::vector<std::uint64_t> persistent_ids_of_cells(const Nodes<dim> &nodes,
                                                     const PartCells<dim> &part_cells,
                                                     unsigned int part);
} // namespace tombolo
