// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>

#include <cstdint>
#include <cstring>

namespace tombolo
{
#if defined(__AVX512F__)
  /** Eight doubles with elementwise arithmetic, on every machine. */
  using EightDoubles = Lanes;
#else
  using EightDoubles = std::experimental::fixed_size_simd<double, 8>;
#endif
  static_assert(EightDoubles::size() == 8, "Lanes of AVX-512 are eight doubles.");

  TOMBOLO_ALWAYS_INLINE EightDoubles load_eight(const double *data)
  {
    return EightDoubles(data, std::experimental::element_aligned);
  }

  TOMBOLO_ALWAYS_INLINE void store_eight(const EightDoubles &value, double *data)
  {
    value.copy_to(data, std::experimental::element_aligned);
  }

  /** (x, y, z, w, x, y, z, w), where @p data has x, y, z and w. */
  TOMBOLO_ALWAYS_INLINE EightDoubles repeat_four(const double *data)
  {
#if defined(__AVX512F__)
    return internal::bit_cast<Lanes>(_mm512_maskz_broadcast_f64x4(0xFF, _mm256_loadu_pd(data)));
#else
    return EightDoubles([&](const auto k) { return data[k % 4]; });
#endif
  }

  /** Square roots. Those of std::simd make GCC 12 warn of its own headers. */
  TOMBOLO_ALWAYS_INLINE EightDoubles root_of(const EightDoubles &value)
  {
#if defined(__AVX512F__)
    return square_root(value);
#else
    return sqrt(value);
#endif
  }

  /** Those of 16 doubles at @p data that have these eight @p numbers, which are below 16. */
  TOMBOLO_ALWAYS_INLINE EightDoubles pick_eight(const double *data, const std::uint8_t *numbers)
  {
#if defined(__AVX512F__)
    const __m512i indices = _mm512_maskz_cvtepu8_epi64(
        0xFF, _mm_loadl_epi64(reinterpret_cast<const __m128i *>(numbers)));
    return internal::bit_cast<Lanes>(
        _mm512_permutex2var_pd(_mm512_loadu_pd(data), indices, _mm512_loadu_pd(data + 8)));
#else
    return EightDoubles([&](const auto k) { return data[numbers[k]]; });
#endif
  }

  /** The sum of all entries. The one of std::simd makes GCC 12 warn of its own headers. */
  TOMBOLO_ALWAYS_INLINE double sum_of(const EightDoubles &value)
  {
    double entries[8];
    store_eight(value, entries);
    for (unsigned int n = 4; n > 0; n /= 2)
      for (unsigned int k = 0; k < n; ++k)
        entries[k] += entries[k + n];
    return entries[0];
  }

  /** Entry k is the sum of all entries of @p values[k]. */
  TOMBOLO_ALWAYS_INLINE EightDoubles sums_of(const EightDoubles (&values)[8])
  {
#if defined(__AVX512F__)
    internal::LaneRegister level[8];
    std::memcpy(level, static_cast<const void *>(values), sizeof level);
    // Pairs of entries, then pairs of pairs, and these again.
    TOMBOLO_UNROLL
    for (unsigned int k = 0; k < 4; ++k)
      level[k] =
          __builtin_shufflevector(level[2 * k], level[2 * k + 1], 0, 8, 2, 10, 4, 12, 6, 14) +
          __builtin_shufflevector(level[2 * k], level[2 * k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    TOMBOLO_UNROLL
    for (unsigned int n = 2; n > 0; --n)
      TOMBOLO_UNROLL
    for (unsigned int k = 0; k < n; ++k)
      level[k] =
          __builtin_shufflevector(level[2 * k], level[2 * k + 1], 0, 1, 4, 5, 8, 9, 12, 13) +
          __builtin_shufflevector(level[2 * k], level[2 * k + 1], 2, 3, 6, 7, 10, 11, 14, 15);
    return internal::bit_cast<Lanes>(level[0]);
#else
    return EightDoubles([&](const auto k) { return sum_of(values[k]); });
#endif
  }
} // namespace tombolo
