// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

namespace tombolo
{
  // Whole numbers of 64 bits among doubles, which hold 32 bits of a number exactly: two for one.
  constexpr unsigned int n_half_bits = 32;

  inline double upper_half(const std::uint64_t number)
  {
    return static_cast<double>(number >> n_half_bits);
  }

  inline double lower_half(const std::uint64_t number)
  {
    return static_cast<double>(number & ((std::uint64_t(1) << n_half_bits) - 1));
  }

  inline std::uint64_t joined(const double upper, const double lower)
  {
    return (static_cast<std::uint64_t>(upper) << n_half_bits) | static_cast<std::uint64_t>(lower);
  }
} // namespace tombolo
