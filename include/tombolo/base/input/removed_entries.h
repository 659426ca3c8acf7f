// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** What to take instead of the entry at @p path, or of its @p value, where that was removed from
   * the program and files of earlier versions may have it; empty where it was not. */
  std::string instead_of_removed(const std::string &path, const std::string &value = "");
} // namespace tombolo
