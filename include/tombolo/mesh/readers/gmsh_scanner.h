// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/readers/text_scanner.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace tombolo
{
  /** Reads the numbers of a file of gmsh, as words or as bytes. All throw MeshFileError. */
  class GmshScanner : public TextScanner
  {
  public:
    using TextScanner::TextScanner;

    /** Numbers are binary from now on. Version 2.2 has no numbers of 8 bytes but coordinates. */
    void begin_binary(const bool is_version_4)
    {
      binary = true;
      has_large_integers = is_version_4;
      count_bytes();
    }

    bool is_binary() const
    {
      return binary;
    }

    /** Moves from the line that begins a section to the first byte of its numbers. */
    void begin_numbers()
    {
      if (binary)
        rest_of_line();
    }

    /** C's `int`. */
    long long small_integer(const char *what)
    {
      return binary ? from_bytes<std::int32_t>(bytes(sizeof(std::int32_t), what)) : integer(what);
    }

    /** C's `size_t`, in version 2.2 an `int`. */
    long long large_integer(const char *what)
    {
      if (!binary || !has_large_integers)
        return small_integer(what);
      return from_bytes<std::int64_t>(bytes(sizeof(std::int64_t), what));
    }

    double number(const char *what)
    {
      if (!binary)
        return real(what);
      const auto value = from_bytes<double>(bytes(sizeof(double), what));
      if (!std::isfinite(value))
        fail(std::string("A number that is not finite stands where ") + what + " should.");
      return value;
    }

    /** The same, not negative. */
    std::size_t small_count(const char *what)
    {
      return not_negative(small_integer(what), what);
    }

    std::size_t large_count(const char *what)
    {
      return not_negative(large_integer(what), what);
    }

  private:
    template <typename Number>
    static Number from_bytes(const std::string_view bytes)
    {
      Number value;
      std::memcpy(&value, bytes.data(), sizeof(Number));
      return value;
    }

    std::size_t not_negative(const long long value, const char *what) const
    {
      if (value < 0)
        fail("\"" + std::to_string(value) + "\" is negative, and stands where " + what +
             " should.");
      return static_cast<std::size_t>(value);
    }

    bool binary = false;
    bool has_large_integers = false;
  };
} // namespace tombolo
