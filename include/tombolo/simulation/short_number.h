// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>

#include <iomanip>
#include <string>

namespace tombolo
{
  /** A number for a sentence. */
  inline std::string short_number(const double value)
  {
    return as_text(std::setprecision(3), value);
  }

  inline std::string percent(const double fraction)
  {
    return short_number(100. * fraction) + " %";
  }
} // namespace tombolo
