// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>

#include <charconv>
#include <cmath>

namespace tombolo
{
  std::string format_number(const double value)
  {
    if (std::isnan(value))
      return "nan";
    if (std::isinf(value))
      return value > 0 ? "inf" : "-inf";
    char text[64];
    const bool is_whole = std::abs(value) < 1e15 && value == std::trunc(value);
    const auto end = is_whole
                         ? std::to_chars(text, text + sizeof(text), static_cast<long long>(value))
                         : std::to_chars(text, text + sizeof(text), value);
    return std::string(text, end.ptr);
  }

  std::string csv_field(const std::string &text)
  {
    if (text.find_first_of(",\"\r\n") == std::string::npos)
      return text;
    std::string result = "\"";
    for (const char character : text)
      result += character == '"' ? "\"\"" : std::string(1, character);
    return result + "\"";
  }
} // namespace tombolo
