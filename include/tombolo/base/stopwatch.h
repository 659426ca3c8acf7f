// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Seconds since @p start. */
  inline double seconds_since(const std::chrono::steady_clock::time_point start)
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /** Wall time by phase on this rank, summed over a run. For a few named phases; measuring one
   * costs two readings of the clock. */
  class Stopwatch
  {
  public:
    /** Adds the time since the last lap() or start() to @p phase, which must be a literal. */
    void lap(const char *phase)
    {
      const auto now = std::chrono::steady_clock::now();
      const double seconds = std::chrono::duration<double>(now - last).count();
      last = now;
      for (auto &[name, sum] : phases)
        if (name == phase)
        {
          sum += seconds;
          return;
        }
      phases.emplace_back(phase, seconds);
    }

    void start()
    {
      last = std::chrono::steady_clock::now();
    }

    /** Phases in the order of their first lap, with their seconds. */
    std::vector<std::pair<std::string, double>> seconds() const
    {
      return {phases.begin(), phases.end()};
    }

  private:
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
    std::vector<std::pair<const char *, double>> phases;
  };
} // namespace tombolo
