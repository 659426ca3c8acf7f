// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>

namespace tombolo
{
  /** Some of n_lanes entries: values and numbers of these are stored one after the other, without a
   * branch that depends on which they are. */
  class SelectedLanes
  {
  public:
    /** Those of the first @p n (at most n_lanes) whose lane of @p mask is set. */
    TOMBOLO_ALWAYS_INLINE SelectedLanes(const LaneMask &mask, const unsigned int n)
        : bits(bits_of(mask) & (n >= n_lanes ? ~0u : (1u << n) - 1u))
    {}

    unsigned int count() const
    {
      return static_cast<unsigned int>(__builtin_popcount(bits));
    }

    /** How many of the lanes before @p lane are selected. */
    unsigned int count_before(const unsigned int lane) const
    {
      return static_cast<unsigned int>(__builtin_popcount(bits & ((1u << lane) - 1u)));
    }

    /** Writes to @p out, which has room for n_lanes whatever the number of the selected is. */
    TOMBOLO_ALWAYS_INLINE void store(const Lanes &value, double *out) const
    {
#if defined(__AVX512F__) && defined(__AVX512VL__)
      _mm512_storeu_pd(out,
                       _mm512_maskz_compress_pd(static_cast<__mmask8>(bits),
                                                internal::bit_cast<internal::LaneRegister>(value)));
#else
      unsigned int index = 0;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        out[index] = value[lane];
        index += (bits >> lane) & 1u;
      }
#endif
    }

    /** The same of @p numbers, n_lanes of them. */
    TOMBOLO_ALWAYS_INLINE void store(const unsigned int *numbers, unsigned int *out) const
    {
#if defined(__AVX512F__) && defined(__AVX512VL__)
      const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(numbers));
      _mm256_storeu_si256(reinterpret_cast<__m256i *>(out),
                          _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), all));
#else
      unsigned int index = 0;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        out[index] = numbers[lane];
        index += (bits >> lane) & 1u;
      }
#endif
    }

    /** The same behind the first @p n_before at @p out, of which it becomes the new number. */
    TOMBOLO_ALWAYS_INLINE void append(const unsigned int *numbers, unsigned int *out,
                                      unsigned int &n_before) const
    {
      store(numbers, out + n_before);
      n_before += count();
    }

  private:
    unsigned int bits;
  };
} // namespace tombolo
