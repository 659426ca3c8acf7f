// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/words_of_type.h>

#include <boost/core/demangle.hpp>

#include <cctype>

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
} // namespace tombolo
