// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** The reason why a directory cannot be made or written, as far as it can be found without
   * writing; empty where there is none. Checks the file system of this rank. */
  std::string what_prevents_directory(const std::string &path);
} // namespace tombolo
