// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace tombolo
{
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
     * `Number` is set, or a time is outside [start, end], or is repeated. */
    OutputSchedule(const Section &section, const double start_time, const double end_time)
        : start_time(start_time), statistics_interval(section.get_double("Statistics interval"))
    {
      const bool has_times = section.is_set("Times"), has_interval = section.is_set("Interval"),
                 has_number = section.is_set("Number");
      if (has_times + has_interval + has_number > 1)
      {
        const std::string entry = has_interval ? "Interval" : "Number";
        section.fail(entry, "only one of Times, Interval and Number can be set; " +
                                std::string(has_times ? "Times" : "Number") +
                                " is set too: remove one");
      }

      const double duration = end_time - start_time;
      if (statistics_interval > 0. && duration / statistics_interval > most_outputs)
        section.fail("Statistics interval",
                     "this makes " + format_number(std::floor(duration / statistics_interval)) +
                         " rows until the end at " + format_number(end_time) +
                         "; at most 1000000 are allowed");
      all_times.push_back(start_time);
      if (has_times)
      {
        for (const double time : section.get_doubles("Times"))
        {
          if (!(time >= start_time && time <= end_time))
            section.fail("Times", "the time " + format_number(time) +
                                      " is not between the start (" + format_number(start_time) +
                                      ") and the end (" + format_number(end_time) + ") of the run");
          all_times.push_back(time);
        }
        std::sort(all_times.begin() + 1, all_times.end());
        for (std::size_t i = 2; i < all_times.size(); ++i)
          if (all_times[i] == all_times[i - 1])
            section.fail("Times", "the time " + format_number(all_times[i]) + " stands twice");
      }
      else if (has_interval && section.get_double("Interval") != 0.)
      {
        const double interval = section.get_positive("Interval");
        if (duration / interval > most_outputs)
          section.fail("Interval", "this makes " + format_number(std::floor(duration / interval)) +
                                       " outputs until the end at " + format_number(end_time) +
                                       "; at most 1000000 are allowed");
        // Multiples, not sums: the hundredth output is not late by a hundred roundings. A last
        // interval that is only rounding is no output of its own.
        for (unsigned int i = 1; i * interval < duration * (1 - 1e-12); ++i)
          all_times.push_back(start_time + i * interval);
      }
      else
      {
        const unsigned int number = section.get_unsigned("Number");
        for (unsigned int i = 1; i < number; ++i)
          all_times.push_back(start_time + duration * i / number);
      }
      all_times.push_back(end_time);
      all_times.erase(std::unique(all_times.begin(), all_times.end()), all_times.end());
    }

    static void declare_parameters(const Entries &e)
    {
      e.entry("Times", "", Patterns::List(Patterns::Double()), "",
              "The times at which results are written, besides start and end. Units: T. Excludes "
              "`Interval` and `Number`.");
      e.number("Interval", "0", at_least(0.), "",
               "The time between outputs, counted from the start. Units: T. 0: see `Number`. "
               "Excludes `Times` and `Number`.");
      e.integer("Number", std::to_string(default_number), between(1, 1000000),
                "The number of outputs after the one at the start, at equal distances, the last at "
                "the end. Excludes `Times` and `Interval`.");
      e.number("Statistics interval", "0", at_least(0.), "",
               "The time between rows of statistics.csv: besides those of outputs there is one at "
               "the first step that reaches each multiple of it. Units: T. 0: at outputs alone.");
    }

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
    void advance(const double time)
    {
      while (!is_finished() && all_times[next] <= time)
        ++next;
    }

    /** For a resumed run: passes to the first time that is not before @p time, where the outputs of
     * that time are still to be written. */
    void resume(const double time)
    {
      while (!is_finished() && all_times[next] < time)
        ++next;
    }

    /** Whether a multiple of `Statistics interval` was reached since the last call; to be called at
     * every step. */
    bool take_statistics_due(const double time)
    {
      if (statistics_interval == 0.)
        return false;
      const unsigned long before = n_statistics_intervals;
      n_statistics_intervals = passed_statistics_intervals(time);
      return n_statistics_intervals > before;
    }

    /** For a resumed run, whose last row can have been at the time of the step before. */
    void resume_statistics(const double previous_time)
    {
      if (statistics_interval > 0.)
        n_statistics_intervals = passed_statistics_intervals(previous_time);
    }

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
    static constexpr double most_outputs = 1e6;
    static constexpr unsigned int default_number = 10;

    std::vector<double> all_times;
    std::size_t next = 0;
    double start_time;
    double statistics_interval;               ///< zero: at outputs alone
    unsigned long n_statistics_intervals = 0; ///< that have passed

    unsigned long passed_statistics_intervals(const double time) const
    {
      // A sum of steps can miss a multiple by round-off.
      return static_cast<unsigned long>(
          std::max(0., std::floor((time - start_time) / statistics_interval + 1e-6)));
    }
  };
} // namespace tombolo
