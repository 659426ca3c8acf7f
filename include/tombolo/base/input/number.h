// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdlib>
#include <string>

namespace tombolo
{
  /** Whether the whole text is one number, which @p value becomes; it need not be finite. */
  inline bool is_number(const std::string &text, double &value)
  {
    char *end = nullptr;
    value = std::strtod(text.c_str(), &end);
    return !text.empty() && end == text.c_str() + text.size();
  }
} // namespace tombolo
