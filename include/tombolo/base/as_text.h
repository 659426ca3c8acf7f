// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sstream>
#include <string>

namespace tombolo
{
  /** Texts and numbers one after the other, as a stream writes them: six digits of a number. */
  template <typename... Parts>
  std::string as_text(const Parts &...parts)
  {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
  }
} // namespace tombolo
