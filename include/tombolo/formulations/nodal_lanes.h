#pragma once

#include <tombolo/base/unroll.h>
#include <tombolo/base/vectorization.h>
#include <tombolo/state/node_partition.h>

#include <cstddef>
#include <cstring>

namespace tombolo
{
  /**
   * Between nodal vectors of n_slots doubles a node and Lanes of one component each: the 4×8
   * transpositions of gather and scatter, written with whole-register shuffles, since std::simd
   * has none and element by element they cost as much as the element itself.
   */
  namespace internal
  {
    using Double4 = double __attribute__((vector_size(32)));
    using Double8 = double __attribute__((vector_size(64)));
    static_assert(n_slots == 4 && n_lanes == 8, "the shuffles are written for these");
    static_assert(sizeof(Lanes) == sizeof(Double8), "Lanes are eight packed doubles");

    TOMBOLO_ALWAYS_INLINE Double4 load_slots(const double *address)
    {
      Double4 value;
      std::memcpy(&value, address, sizeof value);
      return value;
    }

    TOMBOLO_ALWAYS_INLINE Lanes to_lanes(const Double8 &value)
    {
      Lanes lanes;
      std::memcpy(static_cast<void *>(&lanes), &value, sizeof value);
      return lanes;
    }

    TOMBOLO_ALWAYS_INLINE Double8 from_lanes(const Lanes &lanes)
    {
      Double8 value;
      std::memcpy(&value, static_cast<const void *>(&lanes), sizeof value);
      return value;
    }

    TOMBOLO_ALWAYS_INLINE void add_slots(double *address, const Double4 &value)
    {
      Double4 sum;
      std::memcpy(&sum, address, sizeof sum);
      sum += value;
      std::memcpy(address, &sum, sizeof sum);
    }
  } // namespace internal

  /** Components 0 ... dim-1 of eight nodes of a nodal vector with n_slots doubles a node. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void gather_nodes(const double *data, const unsigned int *nodes,
                                          Lanes (&values)[dim])
  {
    using namespace internal;
    const auto pair = [&](const unsigned int i)
    {
      return __builtin_shufflevector(load_slots(data + std::size_t(n_slots) * nodes[i]),
                                     load_slots(data + std::size_t(n_slots) * nodes[i + 4]), 0, 1,
                                     2, 3, 4, 5, 6, 7);
    };
    const Double8 a = pair(0), b = pair(1), c = pair(2), d = pair(3);
    const Double8 ab_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const Double8 ab_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const Double8 cd_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const Double8 cd_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    values[0] = to_lanes(__builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 4, 5, 12, 13));
    values[1] = to_lanes(__builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 4, 5, 12, 13));
    if constexpr (dim == 3)
      values[2] = to_lanes(__builtin_shufflevector(ab_even, cd_even, 2, 3, 10, 11, 6, 7, 14, 15));
  }

  /** Adds to the first @p n_valid of eight nodes, one after the other: nodes may repeat. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void add_to_nodes(const Lanes (&values)[dim], const unsigned int *nodes,
                                          const unsigned int n_valid, double *data)
  {
    using namespace internal;
    const Double8 x = from_lanes(values[0]);
    const Double8 y = from_lanes(values[1]);
    const Double8 zero = {0., 0., 0., 0., 0., 0., 0., 0.};
    Double8 z = zero;
    if constexpr (dim == 3)
      z = from_lanes(values[2]);
    const Double8 xy_even = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
    const Double8 xy_odd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
    const Double8 z_even = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
    const Double8 z_odd = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
    const Double8 pairs[4] = {__builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11, 6, 7, 14, 15),
                              __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
    const auto lower = [&](const unsigned int i)
    { return __builtin_shufflevector(pairs[i], pairs[i], 0, 1, 2, 3); };
    const auto upper = [&](const unsigned int i)
    { return __builtin_shufflevector(pairs[i], pairs[i], 4, 5, 6, 7); };
    const auto address = [&](const unsigned int i)
    { return data + std::size_t(n_slots) * nodes[i]; };

    if (n_valid == n_lanes)
    {
      for (unsigned int i = 0; i < 4; ++i)
        add_slots(address(i), lower(i));
      for (unsigned int i = 0; i < 4; ++i)
        add_slots(address(i + 4), upper(i));
      return;
    }
    for (unsigned int i = 0; i < n_valid; ++i)
      add_slots(address(i), i < 4 ? lower(i) : upper(i - 4));
  }
} // namespace tombolo
