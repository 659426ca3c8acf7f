// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/table_function.h>

#include "text_testing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

using namespace tombolo;
using tombolo::testing::contains;

namespace
{
  std::string table_refusal(const std::string &text)
  {
    try
    {
      const TableFunction table(text);
    }
    catch (const std::invalid_argument &error)
    {
      return error.what();
    }
    return "(nothing was refused)";
  }
} // namespace

TEST(TableFunction, is_linear_between_its_points_and_constant_beyond_them)
{
  const TableFunction table("0, 1\n2, 5\n3, 4\n");
  const double expected[][2] = {{-1, 1}, {0, 1}, {0.5, 2}, {2, 5}, {2.5, 4.5}, {3, 4}, {100, 4}};
  for (const auto &[argument, value] : expected)
    EXPECT_DOUBLE_EQ(table.value(argument), value) << argument;
  EXPECT_TRUE(std::isnan(table.value(std::numeric_limits<double>::quiet_NaN())));
}

TEST(TableFunction, reads_headings_comments_and_all_usual_separators)
{
  for (const std::string text : {"t, f\n0, 1\n2, 3\n", "# t f\n0 1\n\n  2\t3 # the end\r\n",
                                 "time [s]; force [N]\r\n0; 1\r\n2; 3", "0\t1\n2\t3\n"})
    EXPECT_DOUBLE_EQ(TableFunction(text).value(1.), 2.) << text;
}

TEST(TableFunction, what_is_no_table_is_refused_with_its_line)
{
  EXPECT_EQ(table_refusal("0, 1\n1, 2\n1, 3\n"),
            "line 3: arguments must rise from line to line; \"1\" is "
            "not above that of the line before.");
  EXPECT_EQ(table_refusal("0, 1\n2, 2\n1, 3\n").substr(0, 30), "line 3: arguments must rise fr");
  EXPECT_EQ(table_refusal("0, 1\n,2\n"), "line 2: the argument is missing.");
  EXPECT_EQ(table_refusal("0, 1\n1,\n"), "line 2: the value is missing.");
  EXPECT_EQ(table_refusal("0, 1\n1, nan\n"), "line 2: \"nan\" is not a finite number.");
  EXPECT_EQ(table_refusal("0, 1\n1, 2x\n"), "line 2: \"2x\" is not a finite number.");
  EXPECT_EQ(table_refusal("t, f\nt, f\n0, 1\n"), "line 2: \"t\" is not a finite number.");
  EXPECT_EQ(table_refusal("0 1 2\n"),
            "line 1: two numbers are needed, an argument and a value; found 3 "
            "entries.");
  EXPECT_EQ(table_refusal("0, 1\n"), "a table needs two points or more, found 1.");
}

TEST(TableCalls, become_names)
{
  const TableCalls calls(
      "2*table(a b.csv, t) + stable(1) + table ( ../c-1.csv , max(x, table(d, t)))");
  EXPECT_EQ(calls.problem, "");
  EXPECT_EQ(calls.text, "2*table_1 + stable(1) + table_2");
  ASSERT_EQ(calls.calls.size(), 2u);
  EXPECT_EQ(calls.calls[0].file, "a b.csv");
  EXPECT_EQ(calls.calls[0].argument, "t");
  EXPECT_EQ(calls.calls[1].file, "../c-1.csv");
  EXPECT_EQ(calls.calls[1].argument, "max(x, table(d, t))");
}

TEST(TableCalls, without_a_file_or_an_argument_are_a_problem)
{
  for (const std::string text :
       {"table(t)", "table(a.csv, )", "table(, t)", "table(a.csv, t", "table()"})
    EXPECT_TRUE(contains(TableCalls(text).problem, "table(FILE, ARGUMENT)")) << text;
  EXPECT_EQ(TableCalls("table + x").text, "table + x");
}
