// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

#include <cstring>

namespace tombolo
{
  /**
   * Transpositions between n_lanes nodes of four doubles and the Lanes of their three components.
   * They are written with whole-register shuffles, which std::simd does not have; element by
   * element they would cost as much as the computation with the result.
   */
  namespace internal
  {
    using NodeVector = double __attribute__((vector_size(32)));
    using LaneVector = double __attribute__((vector_size(8 * n_lanes)));
    static_assert(sizeof(Lanes) == sizeof(LaneVector), "Lanes are packed doubles");

    TOMBOLO_ALWAYS_INLINE NodeVector load_node_vector(const double *address)
    {
      NodeVector value;
      std::memcpy(&value, address, sizeof value);
      return value;
    }

    TOMBOLO_ALWAYS_INLINE Lanes to_lanes(const LaneVector &value)
    {
      Lanes lanes;
      std::memcpy(static_cast<void *>(&lanes), &value, sizeof value);
      return lanes;
    }

    TOMBOLO_ALWAYS_INLINE LaneVector from_lanes(const Lanes &lanes)
    {
      LaneVector value;
      std::memcpy(&value, static_cast<const void *>(&lanes), sizeof value);
      return value;
    }

    TOMBOLO_ALWAYS_INLINE void add_node_vector(double *address, const NodeVector &value)
    {
      NodeVector sum;
      std::memcpy(&sum, address, sizeof sum);
      sum += value;
      std::memcpy(address, &sum, sizeof sum);
    }

#if defined(__AVX512F__)
    TOMBOLO_ALWAYS_INLINE void nodes_to_lanes(const NodeVector (&node)[8],
                                              LaneVector (&component)[3])
    {
      const auto pair = [&](const unsigned int i)
      { return __builtin_shufflevector(node[i], node[i + 4], 0, 1, 2, 3, 4, 5, 6, 7); };
      const LaneVector a = pair(0), b = pair(1), c = pair(2), d = pair(3);
      const LaneVector ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneVector ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneVector cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneVector cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
      component[0] = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13);
      component[1] = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13);
      component[2] = __builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15);
    }

    TOMBOLO_ALWAYS_INLINE void lanes_to_nodes(const LaneVector (&component)[3],
                                              NodeVector (&node)[8])
    {
      const LaneVector zero = {};
      const LaneVector xy_even =
          __builtin_shufflevector(component[0], component[1], 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneVector xy_odd =
          __builtin_shufflevector(component[0], component[1], 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneVector z_even =
          __builtin_shufflevector(component[2], zero, 0, 8, 2, 10, 4, 12, 6, 14);
      const LaneVector z_odd =
          __builtin_shufflevector(component[2], zero, 1, 9, 3, 11, 5, 13, 7, 15);
      const LaneVector pairs[4] = {
          __builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 4; ++i)
      {
        node[i] = __builtin_shufflevector(pairs[i], pairs[i], 0, 1, 2, 3);
        node[i + 4] = __builtin_shufflevector(pairs[i], pairs[i], 4, 5, 6, 7);
      }
    }
#elif defined(__AVX__)
    TOMBOLO_ALWAYS_INLINE void nodes_to_lanes(const NodeVector (&node)[4],
                                              LaneVector (&component)[3])
    {
      const LaneVector ab_even = __builtin_shufflevector(node[0], node[1], 0, 4, 2, 6);
      const LaneVector ab_odd = __builtin_shufflevector(node[0], node[1], 1, 5, 3, 7);
      const LaneVector cd_even = __builtin_shufflevector(node[2], node[3], 0, 4, 2, 6);
      const LaneVector cd_odd = __builtin_shufflevector(node[2], node[3], 1, 5, 3, 7);
      component[0] = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
      component[1] = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
      component[2] = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
    }

    TOMBOLO_ALWAYS_INLINE void lanes_to_nodes(const LaneVector (&component)[3],
                                              NodeVector (&node)[4])
    {
      const LaneVector zero = {};
      const LaneVector xy_even = __builtin_shufflevector(component[0], component[1], 0, 4, 2, 6);
      const LaneVector xy_odd = __builtin_shufflevector(component[0], component[1], 1, 5, 3, 7);
      const LaneVector z_even = __builtin_shufflevector(component[2], zero, 0, 4, 2, 6);
      const LaneVector z_odd = __builtin_shufflevector(component[2], zero, 1, 5, 3, 7);
      node[0] = __builtin_shufflevector(xy_even, z_even, 0, 1, 4, 5);
      node[1] = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5);
      node[2] = __builtin_shufflevector(xy_even, z_even, 2, 3, 6, 7);
      node[3] = __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7);
    }
#else
    inline void nodes_to_lanes(const NodeVector (&node)[n_lanes], LaneVector (&component)[3])
    {
      for (unsigned int d = 0; d < 3; ++d)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          component[d][lane] = node[lane][d];
    }

    inline void lanes_to_nodes(const LaneVector (&component)[3], NodeVector (&node)[n_lanes])
    {
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        node[lane] = NodeVector{component[0][lane], component[1][lane], component[2][lane], 0.};
    }
#endif
  } // namespace internal
} // namespace tombolo
