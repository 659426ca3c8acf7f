// SPDX-License-Identifier: LGPL-2.1-or-later
#include "text_testing.h"

#include <gtest/gtest.h>

#include <tombolo/base/input/expression.h>

#include <iostream>
#include <thread>

namespace
{
  using namespace tombolo;
  using dealii::Point;
  using tombolo::testing::contains;
  using tombolo::testing::input_error;

  /** One entry "Function" on line 2 of section "A". */
  struct Entry
  {
    explicit Entry(const std::string &text) : parameters(MPI_COMM_WORLD)
    {
      parameters.read_text("subsection A\nset Function = " + text + "\nend\n", "case.prm");
      parameters.handler().enter_subsection("A");
      parameters.handler().declare_entry("Function", "", dealii::Patterns::Anything(), "f.");
      parameters.handler().leave_subsection();
      parameters.assign();
    }

    Section section() const
    {
      return parameters.section("A");
    }

    Parameters parameters;
  };

  template <int dim>
  double value(const std::string &text, const Point<dim> &point, const double time = 0)
  {
    const Entry entry(text);
    return Expression<dim>(entry.section(), "Function", 1).value(point, time);
  }

  template <typename Object>
  std::string refusal_of(const std::string &text, const unsigned int n_components = 1,
                         const bool allow_free = false)
  {
    const Entry entry(text);
    return input_error(
        [&]
        {
          if constexpr (std::is_constructible<Object, const Section &, const std::string &,
                                              unsigned int, bool>::value)
            Object(entry.section(), "Function", n_components, allow_free);
          else
            Object(entry.section(), "Function");
        });
  }

  TEST(Expression, has_the_value_of_the_formula_in_place_and_time)
  {
    EXPECT_DOUBLE_EQ(value<3>("x + 10*y + 100*z + 1000*t", Point<3>(1, 2, 3), 4), 4321);
    EXPECT_DOUBLE_EQ(value<2>("x + 10*y + 100*t", Point<2>(1, 2), 3), 321);
    EXPECT_DOUBLE_EQ(value<2>("2*pi", Point<2>()), 2 * dealii::numbers::PI);
    EXPECT_DOUBLE_EQ(value<3>("if(t < 4, 0.1*sin(pi*t/4)^2, 0)", Point<3>(), 2), 0.1);
    EXPECT_DOUBLE_EQ(value<3>("if(t < 4, 0.1*sin(pi*t/4)^2, 0)", Point<3>(), 5), 0.);
    EXPECT_DOUBLE_EQ(value<2>("x < 1 ? 3 : 4", Point<2>(2, 0)), 4.);
    EXPECT_DOUBLE_EQ(value<2>("1e-3*max(x, y)", Point<2>(2, 5)), 5e-3);
  }

  TEST(Expression, has_components_and_knows_what_they_depend_on)
  {
    const Entry entry("if(t < 4, t, 0); free; 7");
    Expression<3> function(entry.section(), "Function", 3, true);
    const Expression<3> moved(std::move(function));
    EXPECT_EQ(moved.n_components(), 3u);
    EXPECT_FALSE(moved.depends_on_position());
    EXPECT_TRUE(moved.depends_on_time());
    EXPECT_FALSE(moved.is_free(0));
    EXPECT_TRUE(moved.is_free(1));
    EXPECT_EQ(moved.value(Point<3>(), 3., 0), 3.);
    EXPECT_EQ(moved.value(Point<3>(), 3., 2), 7.);
    const Entry steady("tan(x)");
    EXPECT_FALSE(Expression<2>(steady.section(), "Function", 1).depends_on_time());
    EXPECT_TRUE(Expression<2>(steady.section(), "Function", 1).depends_on_position());
  }

  TEST(Expression, wrong_number_of_components_says_how_many_are_needed)
  {
    EXPECT_EQ(refusal_of<Expression<3>>("1; 2", 3),
              "case.prm:2: entry \"A/Function\" = \"1; 2\": 3 components, separated by \";\", are "
              "needed, found 2.");
    EXPECT_TRUE(
        contains(refusal_of<Expression<3>>("1; 2", 1), "one expression is needed, found 2"));
    EXPECT_TRUE(contains(refusal_of<Expression<3>>("", 3), "are needed, found none."));
    EXPECT_TRUE(contains(refusal_of<Expression<3>>("", 1), "one expression is needed, found none"));
    EXPECT_TRUE(
        contains(refusal_of<Expression<2>>("1;", 2), "component 2: there is no expression"));
    EXPECT_TRUE(
        contains(refusal_of<Expression<2>>("1, 2", 1), "components are separated by \";\""));
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("1; free", 2), "\"free\" is not allowed here"));
    EXPECT_EQ(refusal_of<Expression<2>>("1; free", 2, true), "");
  }

  TEST(Expression, what_does_not_parse_is_refused_with_place_and_reason_and_nothing_is_printed)
  {
    ::testing::internal::CaptureStderr();
    const auto refusal = [](const std::string &text) { return refusal_of<Expression<3>>(text); };
    EXPECT_EQ(refusal("sin(x"), "case.prm:2: entry \"A/Function\" = \"sin(x\": this is not an "
                                "expression: Missing parenthesis.");
    EXPECT_TRUE(contains(refusal("x < 1 and y < 1"), "Write \"&&\" instead of \"and\"."));
    EXPECT_TRUE(contains(refusal("x < 1 OR y < 1"), "Write \"||\" instead of \"OR\"."));
    EXPECT_TRUE(contains(refusal("x < 1 & y < 1"), "write \"&&\" instead of \"&\"."));
    EXPECT_TRUE(contains(refusal("not x"), "instead of \"not\""));
    EXPECT_TRUE(contains(refusal("x**2"), "Write \"^\""));
    EXPECT_TRUE(contains(refusal("sqr(x)"), "The name \"sqr\" is unknown. Did you mean \"sqrt\"?"));
    EXPECT_TRUE(contains(refusal("q + 1"), "The variables are x, y, z, t, the constant is pi."));
    for (const std::string text : {"1 +", "x 2", "()", "2..3", "\"x\"", "γ", "sin()", "if(x)", "%",
                                   "x :", "? x", "'", "free + 1", "1e", "x;"})
      EXPECT_TRUE(contains(refusal(text), "case.prm:2: entry \"A/Function\"")) << text;
    refusal(std::string(20000, '(') + "x" + std::string(20000, ')'));
    refusal(std::string(20000, '-') + "x");
    std::cerr << "kept";
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "kept");
  }

  TEST(Expression, z_in_two_dimensions_is_refused_as_such)
  {
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("x + z"),
                         "There is no z in two dimensions: the variables are x, y and t."));
    EXPECT_TRUE(contains(refusal_of<Predicate<2>>("z < 1"), "There is no z in two dimensions"));
    EXPECT_EQ(refusal_of<Expression<3>>("x + z"), "");
  }

  TEST(Expression, what_would_be_misunderstood_is_refused)
  {
    EXPECT_TRUE(contains(refusal_of<Predicate<3>>("x = 5"), "Write \"==\""));
    EXPECT_TRUE(contains(refusal_of<Predicate<3>>("0 < x < 1"), "Write \"0 < x && x < 1\""));
    EXPECT_TRUE(contains(refusal_of<Expression<3>>("x + rand()"), "random numbers"));
    EXPECT_EQ(refusal_of<Predicate<3>>("0 < x && x <= 1 || (y < 1) == (z > 3)"), "");
    EXPECT_EQ(refusal_of<Expression<3>>("if(x < 1, y > 1, z >= 2)"), "");
  }

  TEST(Expression, what_is_finite_nowhere_is_refused)
  {
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("1/0"), "the value is not finite."));
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("sqrt(-1)"), "the value is not finite."));
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("0; x + 1/0", 2),
                         "component 2: the value is not finite at any of 4000 points"));
    EXPECT_TRUE(contains(refusal_of<Expression<2>>("sqrt(-1 - x^2)"), "not finite at any of"));
  }

  TEST(Expression, singular_point_is_refused_only_where_it_is_met)
  {
    const Entry entry("1/x; sqrt(y - 100)");
    const Expression<2> function(entry.section(), "Function", 2);
    EXPECT_EQ(function.value(Point<2>(4, 0), 0., 0), 0.25);
    EXPECT_EQ(function.value(Point<2>(0, 104), 0., 1), 2.);
    try
    {
      function.value(Point<2>(0, 3), 0.5, 0);
      FAIL() << "an infinite value was not refused";
    }
    catch (const RunError &error)
    {
      EXPECT_EQ(std::string(error.what()),
                "case.prm:2: entry \"A/Function\" = \"1/x; sqrt(y - 100)\": component 1 is not "
                "finite (inf) at (0 3), t = 0.5.");
    }
    EXPECT_THROW(function.value(Point<2>(0, 3), 0., 1), RunError);
  }

  TEST(Expression, several_threads_evaluate_at_their_own_times)
  {
    const Entry entry("x*t");
    const Expression<2> function(entry.section(), "Function", 1);
    std::vector<unsigned int> n_wrong(4, 0);
    std::vector<std::thread> threads;
    for (unsigned int thread = 0; thread < n_wrong.size(); ++thread)
      threads.emplace_back(
          [&, thread]
          {
            for (unsigned int i = 0; i < 20000; ++i)
              n_wrong[thread] += function.value(Point<2>(i, 0), thread) != 1. * i * thread;
          });
    for (auto &thread : threads)
      thread.join();
    EXPECT_EQ(n_wrong, std::vector<unsigned int>(4, 0));
  }

  TEST(Predicate, is_true_where_the_condition_holds)
  {
    const Entry entry("x < 5 && y > 0");
    const Predicate<3> predicate(entry.section(), "Function");
    EXPECT_TRUE(predicate(Point<3>(4, 1, 0)));
    EXPECT_FALSE(predicate(Point<3>(5, 1, 0)));
    EXPECT_FALSE(predicate(Point<3>(4, 0, 0)));
    const Entry everywhere("1");
    EXPECT_TRUE(Predicate<2>(everywhere.section(), "Function")(Point<2>(1, 1)));
  }

  TEST(Predicate, number_that_is_no_condition_is_refused)
  {
    EXPECT_TRUE(contains(refusal_of<Predicate<3>>("x - 5"), "a condition is needed"));
    EXPECT_TRUE(contains(refusal_of<Predicate<3>>("t < 1"), "cannot depend on t"));
    EXPECT_TRUE(contains(refusal_of<Predicate<3>>("1; 2"), "one expression is needed, found 2"));
    EXPECT_EQ(refusal_of<Predicate<3>>("x < 1/0 - 1/0"), "");
  }

  TEST(Predicate, value_that_is_not_finite_is_refused)
  {
    const Entry entry("sqrt(x) + (x > 1)");
    const Predicate<2> predicate(entry.section(), "Function");
    EXPECT_TRUE(predicate(Point<2>(4, 0)));
    EXPECT_THROW(predicate(Point<2>(-1, 0)), InputError);
    EXPECT_TRUE(contains(refusal_of<Predicate<2>>("1/0"), "not finite"));
  }
} // namespace
