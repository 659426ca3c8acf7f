// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/state/nodal_vector.h>

#include <cstddef>

namespace tombolo
{
  /** Starts to load what @p fields, nodal arrays, have at nodes that a sweep over all rows meets
   * first some rows after @p row: those at the ends of the thirds of its neighbours, on a
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

  /** Starts to load the φ of a row some rows after @p row, where @p with_values, and its ∇φ, where
   * @p with_gradients. Processors look ahead by themselves, but only up to the end of a page, which
   * holds some seven rows. Few rows, or rows kept once, stay in the caches. */
  template <bool with_values, bool with_gradients>
  TOMBOLO_ALWAYS_INLINE void fetch_coefficients_ahead(const Stencils &shape, const unsigned int row)
  {
    constexpr std::size_t n_ahead = 4, n_in_caches = 500000, n_of_line = 8;
    const std::size_t later = row + n_ahead;
    if (later >= shape.particle_node.size() || shape.value.size() < n_in_caches)
      return;
    const std::size_t size = shape.row_start[later + 1] - shape.row_start[later];
    const double *const value = shape.value.data() + shape.coefficient_start[later];
    const double *const gradient =
        shape.gradient.data() + Stencils::n_gradient * shape.coefficient_start[later];
    for (std::size_t k = 0; k < Stencils::n_gradient * size && with_gradients; k += n_of_line)
      __builtin_prefetch(gradient + k);
    for (std::size_t k = 0; k < size && with_values; k += n_of_line)
      __builtin_prefetch(value + k);
  }
} // namespace tombolo
