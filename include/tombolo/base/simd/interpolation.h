// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
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
