// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameter_scanner.h>

#include <string>

namespace tombolo
{
  /** What an override of the command line, "Section/Entry = value", sets; blanks around names do
   * not count. Throws InputError. */
  ParameterScanner::Item read_override(const std::string &assignment);
} // namespace tombolo
