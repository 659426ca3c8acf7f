// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** Text as it stands in XML, also within the quotes of an attribute. */
  inline std::string xml_escaped(const std::string &text)
  {
    std::string result;
    for (const char character : text)
      switch (character)
      {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
      }
    return result;
  }
} // namespace tombolo
