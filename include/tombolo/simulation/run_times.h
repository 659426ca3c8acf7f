// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <sys/resource.h>

#include <chrono>

namespace tombolo
{
  /** Seconds since @p start. */
  inline double seconds_since(const std::chrono::steady_clock::time_point start)
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /** Processor time of this process since its start, of its own and of the system for it [s]. */
  inline double processor_seconds()
  {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  }

  /** A moment of a run, by both clocks. */
  struct Moment
  {
    std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
    double processor = processor_seconds();
  };

  /** What a part of a run takes on this rank [s]. */
  struct Duration
  {
    double wall = 0, processor = 0;

    void add_since(const Moment &start)
    {
      wall += seconds_since(start.wall);
      processor += processor_seconds() - start.processor;
    }
  };

  /** Times of a run, of this rank. */
  struct RunTimes
  {
    Duration loop;   ///< steps and what is written between them
    Duration output; ///< what is written

    Duration step_duration() const
    {
      return {loop.wall - output.wall, loop.processor - output.processor};
    }

    double before_resumption = 0; ///< wall time [s]
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  };
} // namespace tombolo
