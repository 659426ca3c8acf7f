// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>

namespace tombolo
{
  /** Seconds since @p start. */
  inline double seconds_since(const std::chrono::steady_clock::time_point start)
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /** Wall times of a run, of this rank [s]. */
  struct WallTimes
  {
    double loop = 0, output = 0;
    double before_resumption = 0;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  };
} // namespace tombolo
