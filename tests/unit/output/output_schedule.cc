// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/output/output_schedule.h>

#include "text_testing.h"

#include <gtest/gtest.h>

#include <limits>

using namespace tombolo;
using tombolo::testing::contains;
using tombolo::testing::input_error;

namespace
{
  OutputSchedule schedule_of(const std::string &text, const double start = 0, const double end = 20)
  {
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("subsection Output\n" + text + "end\n", "test.prm");
    parameters.handler().enter_subsection("Output");
    OutputSchedule::declare_parameters(Entries(parameters.handler()));
    parameters.handler().leave_subsection();
    parameters.assign();
    return OutputSchedule(parameters.section("Output"), start, end);
  }

  std::string message_of(const std::string &text)
  {
    return input_error([&] { schedule_of(text); });
  }

  using Times = std::vector<double>;
} // namespace

TEST(OutputSchedule, listed_times_come_in_order_with_start_and_end)
{
  EXPECT_EQ(schedule_of("set Times = 9, 4, 6\n").times(), (Times{0, 4, 6, 9, 20}));
  EXPECT_EQ(schedule_of("set Times = 0, 4, 20\n").times(), (Times{0, 4, 20}));
}

TEST(OutputSchedule, interval_counts_from_the_start_without_accumulated_rounding)
{
  EXPECT_EQ(schedule_of("set Interval = 0.25\n", 1, 2.1).times(),
            (Times{1, 1.25, 1.5, 1.75, 2, 2.1}));
  const auto times = schedule_of("set Interval = 0.1\n", 0, 100).times();
  ASSERT_EQ(times.size(), 1001u);
  EXPECT_EQ(times[999], 999 * 0.1);
  EXPECT_EQ(times[1000], 100);
  EXPECT_EQ(schedule_of("set Interval = 0.1\n", 0, 0.3).times().size(), 4u);
}

TEST(OutputSchedule, number_divides_the_run_evenly)
{
  EXPECT_EQ(schedule_of("set Number = 4\n").times(), (Times{0, 5, 10, 15, 20}));
  EXPECT_EQ(schedule_of("set Number = 1\n").times(), (Times{0, 20}));
  EXPECT_EQ(schedule_of("").times().size(), 11u);
}

TEST(OutputSchedule, next_time_is_exact_and_passes_times_that_were_stepped_over)
{
  OutputSchedule schedule = schedule_of("set Times = 4, 6, 9\n");
  EXPECT_TRUE(schedule.is_due(0));
  schedule.advance(0);
  EXPECT_EQ(schedule.next_time(), 4);
  EXPECT_FALSE(schedule.is_due(std::nextafter(4., 0.)));
  schedule.advance(7);
  EXPECT_EQ(schedule.next_time(), 9);
  schedule.advance(9);
  schedule.advance(20);
  EXPECT_TRUE(schedule.is_finished());
  EXPECT_EQ(schedule.next_time(), std::numeric_limits<double>::max());
}

TEST(OutputSchedule, contradicting_or_useless_entries_are_refused_with_their_place)
{
  const std::string both = message_of("set Times = 1\nset Interval = 2\n");
  EXPECT_TRUE(contains(both, "test.prm:3"));
  EXPECT_TRUE(contains(both, "only one of"));
  EXPECT_TRUE(contains(message_of("set Times = 1, 21\n"), "the time 21 is not between"));
  EXPECT_TRUE(contains(message_of("set Times = 3, 1, 3\n"), "the time 3 stands twice"));
  EXPECT_TRUE(contains(message_of("set Interval = 1e-9\n"), "at most 1000000"));
  EXPECT_NE(message_of("set Interval = -1\n"), "");
}

TEST(OutputSchedule, rows_of_statistics_come_at_the_first_step_that_reaches_a_multiple)
{
  OutputSchedule schedule = schedule_of("set Statistics interval = 1\n");
  std::vector<double> rows;
  for (const double time : {0., 0.4, 0.8, 1.2, 1.6, 2. - 1e-12, 2.4, 4.1, 4.2})
    if (schedule.take_statistics_due(time))
      rows.push_back(time);
  EXPECT_EQ(rows, (Times{1.2, 2. - 1e-12, 4.1}));
  EXPECT_EQ(schedule.times().size(), 11u);
}

TEST(OutputSchedule, resumed_run_has_the_rows_of_statistics_that_the_whole_has)
{
  OutputSchedule schedule = schedule_of("set Statistics interval = 1\n");
  // The row of 1.2 was not written when the checkpoint was, that of 0.8 was none.
  schedule.resume_statistics(0.8);
  EXPECT_TRUE(schedule.take_statistics_due(1.2));
  schedule.resume_statistics(1.2);
  EXPECT_FALSE(schedule.take_statistics_due(1.6));
}

TEST(OutputSchedule, statistics_have_no_rows_of_their_own_without_an_interval)
{
  OutputSchedule schedule = schedule_of("set Number = 4\n");
  schedule.resume_statistics(1.);
  EXPECT_FALSE(schedule.take_statistics_due(10.));
  EXPECT_TRUE(contains(message_of("set Statistics interval = 1e-6\n"), "at most 1000000"));
}
