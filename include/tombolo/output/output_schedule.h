// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace tombolo
{
  class Entries;
  class Section;

  /**
   * The times at which results are written: the start, then those of the entry `Times`, or every
   * `Interval`, or `Number` times at equal distances, and the end, each exactly once. The
   * simulation shortens steps to meet next_time() and calls advance() when it has written.
   *
   * Rows of the statistics can come more often, by `Statistics interval`: steps are not shortened
   * for them.
   */
  class OutputSchedule
  {
  public:
    /** Reads section Output. Throws InputError where more than one of `Times`, `Interval` and
     * `Number` is set, or a time is outside [start, end], or stands twice. */
    OutputSchedule(const Section &section, double start_time, double end_time);

    static void declare_parameters(const Entries &e);

    /** The next time of an output; the largest double where none is left. */
    double next_time() const
    {
      return is_finished() ? std::numeric_limits<double>::max() : all_times[next];
    }

    /** Whether an output is due at @p time: it is not before next_time(). */
    bool is_due(const double time) const
    {
      return time >= next_time();
    }

    /** Passes to the first time after @p time. */
    void advance(double time);

    /** For a resumed run: passes to the first time that is not before @p time, where the outputs of
     * that time are still to be written. */
    void resume(double time);

    /** Whether a multiple of `Statistics interval` was reached since the last call; to be called at
     * every step. */
    bool take_statistics_due(double time);

    /** For a resumed run, whose last row can have been at @p previous_time, that of the step
     * before. */
    void resume_statistics(double previous_time);

    bool is_finished() const
    {
      return next == all_times.size();
    }

    /** All times, ascending, start and end included. */
    const std::vector<double> &times() const
    {
      return all_times;
    }

  private:
    std::vector<double> all_times;
    std::size_t next = 0;
    double start_time;
    double statistics_interval;               ///< zero: at outputs alone
    unsigned long n_statistics_intervals = 0; ///< that have passed

    unsigned long passed_statistics_intervals(double time) const;
  };
} // namespace tombolo
