// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/state/node_partition.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * Finds the bodies that the particles of one part make: two are of one fragment where a chain of
   * bonds connects them, each bond in the row of either end; debris without bonds is a fragment of
   * its own. Row i of @p shape is the particle with the identifier ids[i], on @p partition. Returns
   * the label of each row, the smallest identifier in its fragment: the same whatever the number of
   * ranks. Images in planes of symmetry connect nothing. Collective.
   */
  std::vector<std::uint64_t> find_fragments(const Stencils &shape,
                                            const std::vector<std::uint64_t> &ids,
                                            const NodePartition &partition);
} // namespace tombolo
