// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** A number of the headers that this library was built with, which another content of any of them
   * changes. */
  std::string present_headers();
} // namespace tombolo
