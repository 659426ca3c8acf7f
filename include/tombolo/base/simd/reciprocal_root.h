// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
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
} // namespace tombolo
