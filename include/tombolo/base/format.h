// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** A number as text: the shortest that reads back as the same double; whole numbers without a
   * point; "nan", "inf", "-inf". */
  std::string format_number(double value);

  /** A field of a table of comma-separated values, quoted where it must be (RFC 4180). */
  std::string csv_field(const std::string &text);
} // namespace tombolo
