// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** A sentence for the user where this processor has wider vectors than the library was compiled
   * for, so that another build can be faster; empty elsewhere. Not collective. */
  std::string advice_on_processor();
} // namespace tombolo
