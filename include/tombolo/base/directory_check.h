// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tombolo
{
  /** Why a directory cannot be made or written, as far as it shows without writing anything; empty
   * where nothing speaks against it. Looks at the file system of this rank. */
  std::string what_prevents_directory(const std::string &path);
} // namespace tombolo
