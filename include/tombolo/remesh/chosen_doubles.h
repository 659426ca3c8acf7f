// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>

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

  /** The sums of all entries of @p a and of @p b, four times. */
  TOMBOLO_ALWAYS_INLINE EightDoubles sums_of_two(const EightDoubles &a, const EightDoubles &b)
  {
    EightDoubles sum = choose_eight<0, 8, 2, 10, 4, 12, 6, 14>(a, b) +
                       choose_eight<1, 9, 3, 11, 5, 13, 7, 15>(a, b);
    sum += choose_eight<2, 3, 0, 1, 6, 7, 4, 5>(sum, sum);
    return sum + choose_eight<4, 5, 6, 7, 0, 1, 2, 3>(sum, sum);
  }
} // namespace tombolo
