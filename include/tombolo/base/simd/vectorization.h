// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <experimental/simd>

namespace tombolo
{
  /** As many doubles as one register of the machine holds, with elementwise arithmetic. Wider ones
   * (std::simd of a fixed size) are passed through memory, at five times the cost. deal.II's
   * VectorizedArray cannot serve: Debian builds it with a width of one. */
  using Lanes = std::experimental::native_simd<double>;

  /** The result of a comparison of Lanes. */
  using LaneMask = Lanes::mask_type;

  /** The number of points or cells that one vector instruction treats together: 8 with AVX-512, 4
   * with AVX, 2 in portable code. */
  constexpr unsigned int n_lanes = Lanes::size();

  /** Four doubles, the padded vector of one node: one register with AVX, two in portable code. */
  using NodeLanes =
      std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, 4>>;

  /** n rounded up to whole Lanes. */
  constexpr unsigned int padded_to_lanes(const unsigned int n)
  {
    return (n + n_lanes - 1) / n_lanes * n_lanes;
  }

  TOMBOLO_ALWAYS_INLINE Lanes load_lanes(const double *data)
  {
    return Lanes(data, std::experimental::element_aligned);
  }

  TOMBOLO_ALWAYS_INLINE void store_lanes(const Lanes &value, double *data)
  {
    value.copy_to(data, std::experimental::element_aligned);
  }

  TOMBOLO_ALWAYS_INLINE NodeLanes load_node(const double *data)
  {
    return NodeLanes(data, std::experimental::element_aligned);
  }

  TOMBOLO_ALWAYS_INLINE void store_node(const NodeLanes &value, double *data)
  {
    value.copy_to(data, std::experimental::element_aligned);
  }

  /** (x, y, z, 0) */
  TOMBOLO_ALWAYS_INLINE NodeLanes node_of(const double x, const double y, const double z)
  {
    alignas(32) const double components[4] = {x, y, z, 0.};
    return load_node(components);
  }

  /** √ of each lane. The one of std::simd makes GCC 12 warn of its own headers, and by halves of a
   * register, as GCC has the loop, the root comes back late. */
  TOMBOLO_ALWAYS_INLINE Lanes square_root(const Lanes &value)
  {
#if defined(__AVX512F__)
    __m512d root;
    static_assert(sizeof(root) == sizeof(value), "Lanes are packed doubles.");
    std::memcpy(&root, static_cast<const void *>(&value), sizeof root);
    root = _mm512_maskz_sqrt_pd(0xFF, root);
    Lanes result;
    std::memcpy(static_cast<void *>(&result), &root, sizeof root);
    return result;
#else
    alignas(64) double entries[n_lanes];
    store_lanes(value, entries);
    for (double &entry : entries)
      entry = std::sqrt(entry);
    return load_lanes(entries);
#endif
  }

  /** Appends those of the first @p n (at most n_lanes) @p numbers whose lane of @p mask is set to
   * @p out, which has room for n_lanes more, after the @p count numbers there; no branch depends on
   * the mask. Returns the new count. */
  inline unsigned int append_selected(const LaneMask &mask, const unsigned int n,
                                      const unsigned int *numbers, unsigned int *out,
                                      unsigned int count)
  {
#if defined(__AVX512F__) && defined(__AVX512VL__)
    __mmask8 bits;
    static_assert(sizeof(mask) == sizeof(bits), "A mask is one bit a lane.");
    std::memcpy(&bits, static_cast<const void *>(&mask), sizeof bits);
    // GCC 12 takes the mask register whole, with what is above its eight bits.
    asm("" : "+q"(bits));
    const unsigned int selected = bits & (n >= n_lanes ? 0xFFu : (1u << n) - 1u);
    const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(numbers));
    _mm256_storeu_si256(reinterpret_cast<__m256i *>(out + count),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(selected), all));
    return count + static_cast<unsigned int>(__builtin_popcount(selected));
#else
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      out[count] = numbers[lane];
      count += lane < n && mask[lane] ? 1 : 0;
    }
    return count;
#endif
  }
} // namespace tombolo
