// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/present_headers.h>

#include <tombolo/headers.h>

namespace tombolo
{
  std::string present_headers()
  {
    return TOMBOLO_HEADERS;
  }
} // namespace tombolo
