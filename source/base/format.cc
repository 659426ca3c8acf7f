// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/json.h>

#include <boost/algorithm/string/replace.hpp>
#include <boost/core/demangle.hpp>

#include <nlohmann/json.hpp>

#include <cctype>
#include <charconv>
#include <cmath>

namespace tombolo
{
  std::string words_of_type(const std::type_info &type)
  {
    std::string name = boost::core::demangle(type.name());
    name = name.substr(0, name.find('<'));
    name = name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1);
    std::string words;
    for (const char c : name)
    {
      if (std::isupper(static_cast<unsigned char>(c)) != 0 && !words.empty())
        words += ' ';
      words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return words;
  }

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
    return "\"" + boost::replace_all_copy(text, "\"", "\"\"") + "\"";
  }

  std::string json_text(const Json &document)
  {
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
  }
} // namespace tombolo
