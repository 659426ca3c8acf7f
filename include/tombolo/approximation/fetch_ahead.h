// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>

namespace tombolo
{
  /** Starts to load what @p fields, nodal arrays, have at nodes that a sweep over all rows meets
   * first in a row a little behind @p row: those at the ends of the thirds of its neighbours, on a
   * lattice of its layers. Else sweeps would wait for memory half of their time, unless the fields
   * of few rows stay in the caches. */
  template <typename... Fields>
  TOMBOLO_ALWAYS_INLINE void fetch_ahead(const Stencils &shape, const unsigned int row,
                                         const Fields *const... fields)
  {
    constexpr std::size_t n_ahead = 8, n_in_caches = 10000;
    const std::size_t later = row + n_ahead, n_rows = shape.particle_node.size();
    if (later >= n_rows || n_rows < n_in_caches)
      return;
    const std::size_t size = shape.row_start[later + 1] - shape.row_start[later];
    for (unsigned int third = 0; third < 3 && size > 0; ++third)
    {
      const std::size_t entry = shape.row_start[later + 1] - 1 - third * (size / 3);
      (__builtin_prefetch(fields + std::size_t(shape.neighbour[entry]) * node_stride), ...);
    }
  }
} // namespace tombolo
