// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>

#include <cstdint>
#include <cstring>

namespace tombolo
{
  /** The entries of @p a and @p b with these numbers; those of @p b are counted on from eight. */
  template <int... numbers>
  TOMBOLO_ALWAYS_INLINE EightDoubles choose_eight(const EightDoubles &a, const EightDoubles &b)
  {
    static_assert(sizeof...(numbers) == 8, "There are eight of them.");
#if defined(__AVX512F__)
    using Register = double __attribute__((vector_size(64)));
    Register of_a, of_b;
    std::memcpy(&of_a, static_cast<const void *>(&a), sizeof of_a);
    std::memcpy(&of_b, static_cast<const void *>(&b), sizeof of_b);
    const Register chosen = __builtin_shufflevector(of_a, of_b, numbers...);
    EightDoubles result;
    std::memcpy(static_cast<void *>(&result), &chosen, sizeof result);
    return result;
#else
    double entries[16];
    store_eight(a, entries);
    store_eight(b, entries + 8);
    const double chosen[8] = {entries[numbers]...};
    return load_eight(chosen);
#endif
  }

  /** Those of @p n doubles, 8 or 16, at @p data that have these eight @p numbers. */
  template <unsigned int n>
  TOMBOLO_ALWAYS_INLINE EightDoubles pick_eight_of(const double *data, const std::uint8_t *numbers)
  {
    static_assert(n == 8 || n == 16, "There are one or two sets of eight.");
#if defined(__AVX512F__)
    if constexpr (n == 8)
    {
      const __m512i indices = _mm512_maskz_cvtepu8_epi64(
          0xFF, _mm_loadl_epi64(reinterpret_cast<const __m128i *>(numbers)));
      const __m512d picked = _mm512_maskz_permutexvar_pd(0xFF, indices, _mm512_loadu_pd(data));
      EightDoubles result;
      std::memcpy(static_cast<void *>(&result), &picked, sizeof result);
      return result;
    }
#endif
    return pick_eight(data, numbers);
  }

  /** 1/x but for round-off, of numbers that are not denormal. */
  TOMBOLO_ALWAYS_INLINE EightDoubles inverse_of(const EightDoubles &value)
  {
#if defined(__AVX512F__)
    __m512d of_value;
    std::memcpy(&of_value, static_cast<const void *>(&value), sizeof of_value);
    const __m512d estimate = _mm512_maskz_rcp14_pd(0xFF, of_value);
    EightDoubles result;
    std::memcpy(static_cast<void *>(&result), &estimate, sizeof result);
    // Newton's method doubles the number of digits.
    for (unsigned int step = 0; step < 2; ++step)
      result += result * (1. - value * result);
    return result;
#else
    return 1. / value;
#endif
  }

  /** The sums of all entries of @p a and of @p b, four times. */
  TOMBOLO_ALWAYS_INLINE EightDoubles sums_of_two(const EightDoubles &a, const EightDoubles &b)
  {
    EightDoubles sum = choose_eight<0, 8, 2, 10, 4, 12, 6, 14>(a, b) +
                       choose_eight<1, 9, 3, 11, 5, 13, 7, 15>(a, b);
    sum += choose_eight<2, 3, 0, 1, 6, 7, 4, 5>(sum, sum);
    return sum + choose_eight<4, 5, 6, 7, 0, 1, 2, 3>(sum, sum);
  }
} // namespace tombolo
