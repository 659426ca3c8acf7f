// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** The names in the entry @p list at the top of the file, each of which stands for a section such
   * as "Part: NAME". Throws InputError where one is missing, stands twice, or contains "/", which
   * separates a section from what is in it. */
  std::vector<std::string> section_names(const Parameters &parameters, const std::string &list);
} // namespace tombolo
