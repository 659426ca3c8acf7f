// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>

namespace tombolo
{
  /** What this process has allocated and not released [bytes]; its resident memory where the system
   * does not count allocations. */
  std::size_t allocated_bytes();
} // namespace tombolo
