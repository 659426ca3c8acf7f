// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/readers/gmsh_scanner.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace tombolo
{
  namespace
  {
    template <typename Number>
    Number from_bytes(const std::string_view bytes)
    {
      Number value;
      std::memcpy(&value, bytes.data(), sizeof(Number));
      return value;
    }
  } // namespace

  void GmshScanner::begin_binary(const bool is_version_4)
  {
    binary = true;
    has_large_integers = is_version_4;
    count_bytes();
  }

  bool GmshScanner::is_binary() const
  {
    return binary;
  }

  void GmshScanner::begin_numbers()
  {
    if (binary)
      rest_of_line();
  }

  long long GmshScanner::small_integer(const char *what)
  {
    return binary ? from_bytes<std::int32_t>(bytes(sizeof(std::int32_t), what)) : integer(what);
  }

  long long GmshScanner::large_integer(const char *what)
  {
    if (!binary || !has_large_integers)
      return small_integer(what);
    return from_bytes<std::int64_t>(bytes(sizeof(std::int64_t), what));
  }

  double GmshScanner::number(const char *what)
  {
    if (!binary)
      return real(what);
    const auto value = from_bytes<double>(bytes(sizeof(double), what));
    if (!std::isfinite(value))
      fail(std::string("A number that is not finite stands where ") + what + " should.");
    return value;
  }

  std::size_t GmshScanner::not_negative(const long long value, const char *what) const
  {
    if (value < 0)
      fail("\"" + std::to_string(value) + "\" is negative, and stands where " + what + " should.");
    return static_cast<std::size_t>(value);
  }

  std::size_t GmshScanner::small_count(const char *what)
  {
    return not_negative(small_integer(what), what);
  }

  std::size_t GmshScanner::large_count(const char *what)
  {
    return not_negative(large_integer(what), what);
  }
} // namespace tombolo
