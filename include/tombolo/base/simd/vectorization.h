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

  namespace internal
  {
    /** Registers as the compiler shuffles them. std::simd has no shuffles, and element by element a
     * transposition would cost as much as the computation with its result. */
    using NodeRegister = double __attribute__((vector_size(32)));
    using LaneRegister = double __attribute__((vector_size(8 * n_lanes)));
    static_assert(sizeof(NodeLanes) == sizeof(NodeRegister), "NodeLanes are packed doubles");
    static_assert(sizeof(Lanes) == sizeof(LaneRegister), "Lanes are packed doubles");

    template <typename To, typename From>
    TOMBOLO_ALWAYS_INLINE To bit_cast(const From &from)
    {
      To to;
      static_assert(sizeof(to) == sizeof(from), "The same bits");
      std::memcpy(static_cast<void *>(&to), static_cast<const void *>(&from), sizeof to);
      return to;
    }
  } // namespace internal

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

  TOMBOLO_ALWAYS_INLINE void add_to_node(const NodeLanes &value, double *data)
  {
    store_node(load_node(data) + value, data);
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
    return internal::bit_cast<Lanes>(
        _mm512_maskz_sqrt_pd(0xFF, internal::bit_cast<internal::LaneRegister>(value)));
#else
    alignas(64) double entries[n_lanes];
    store_lanes(value, entries);
    for (double &entry : entries)
      entry = std::sqrt(entry);
    return load_lanes(entries);
#endif
  }

  /** The set entries of a mask as bits, the first one lowest. */
  template <typename Mask>
  TOMBOLO_ALWAYS_INLINE unsigned int bits_of(const Mask &mask)
  {
#if defined(__AVX512F__)
    auto bits = internal::bit_cast<__mmask8>(mask);
    // GCC 12 takes the mask register whole, with what is above its eight bits.
    asm("" : "+q"(bits));
    return bits & 0xFFu;
#else
    unsigned int bits = 0;
    for (unsigned int k = 0; k < Mask::size(); ++k)
      bits |= (mask[k] ? 1u : 0u) << k;
    return bits;
#endif
  }

  /** 1/√value of positive normal numbers, to round-off. Where the machine estimates it, two steps
   * of Newton's method are a small part of a root and a division. */
  TOMBOLO_ALWAYS_INLINE Lanes reciprocal_root(const Lanes &value)
  {
#if defined(__AVX512F__)
    auto result = internal::bit_cast<Lanes>(
        _mm512_maskz_rsqrt14_pd(0xFF, internal::bit_cast<internal::LaneRegister>(value)));
    const Lanes half = 0.5 * value;
    for (unsigned int step = 0; step < 2; ++step)
      result += result * (0.5 - half * (result * result));
    return result;
#else
    return 1. / square_root(value);
#endif
  }

  /** Straight lines between @p values at 0, 1, ...: their value at @p position, which is not
   * negative, and values[end] from @p end on. There are values[0] ... values[end + 1]. */
  TOMBOLO_ALWAYS_INLINE Lanes interpolate_lanes(const double *values, const Lanes &position,
                                                const unsigned int end)
  {
#if defined(__AVX512F__) && defined(__AVX512VL__)
    __m512d at = internal::bit_cast<internal::LaneRegister>(position);
    // By masks, since GCC 12 warns of what its own functions without a mask leave undefined.
    constexpr __mmask8 all = 0xFF;
    const __m512d zero = _mm512_setzero_pd();
    at = _mm512_maskz_min_pd(all, at, _mm512_set1_pd(end)); // the end, too, of what is no number
    const __m256i index = _mm512_maskz_cvttpd_epi32(all, at);
    const __m512d low = _mm512_mask_i32gather_pd(zero, all, index, values, 8);
    const __m512d high = _mm512_mask_i32gather_pd(zero, all, index, values + 1, 8);
    at = _mm512_fmadd_pd(_mm512_sub_pd(at, _mm512_maskz_cvtepi32_pd(all, index)),
                         _mm512_sub_pd(high, low), low);
    return internal::bit_cast<Lanes>(at);
#else
    alignas(64) double entries[n_lanes];
    store_lanes(position, entries);
    for (double &entry : entries)
    {
      entry = entry < end ? entry : end;
      const auto interval = static_cast<unsigned int>(entry);
      entry = values[interval] + (entry - interval) * (values[interval + 1] - values[interval]);
    }
    return load_lanes(entries);
#endif
  }
} // namespace tombolo
