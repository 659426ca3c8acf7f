// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "text_testing.h"

#include <gtest/gtest.h>

#include <tombolo/base/input/parameters.h>

#include <mpi.h>

#include <algorithm>

namespace
{
  using namespace tombolo;
  using dealii::ParameterHandler;
  using tombolo::testing::contains;
  using tombolo::testing::input_error;
  namespace Patterns = dealii::Patterns;

  void declare_shapes(ParameterHandler &handler)
  {
    handler.declare_entry("Parts", "", Patterns::Anything(), "Names of the parts.");
    handler.declare_entry("Steps", "10", Patterns::Integer(1), "Number of steps.");
    for (const char *const name : {"Height", "Radius", "Length"})
      Parameters::declare_mandatory(handler, name, Patterns::Double(0.), "A size.");
    handler.enter_subsection("Mesh");
    Parameters::declare_mandatory(handler, "Type", Patterns::Selection("box|disc"), "Which.");
    handler.leave_subsection();
  }

  /** All that is wrong with a text that is read to its end. */
  std::string mistakes_in(const std::string &text, const std::vector<std::string> &overrides = {})
  {
    return input_error(
        [&]
        {
          Parameters parameters(MPI_COMM_WORLD);
          parameters.collect_mistakes();
          parameters.read_text(text, "case.prm");
          for (const std::string &override : overrides)
            parameters.attempt([&] { parameters.add_override(override); });
          declare_shapes(parameters.handler());
          parameters.raw_list("Parts");
          parameters.assign();
          const Section root = parameters.section("");
          for (const char *const entry : {"Parts", "Steps", "Height", "Radius", "Length"})
            parameters.attempt([&] { root.get(entry); });
          parameters.attempt(
              [&]
              {
                const double height = root.get_positive("Height");
                if (height < root.get_double("Radius"))
                  root.fail("Height", "it is too low.");
              });
          parameters.attempt([&] { root.subsection("Mesh").get("Type"); });
          parameters.refuse_unused();
          parameters.refuse_mistakes();
        });
  }

  const std::string sizes = "set Height = 3\nset Radius = 2\nset Length = 1\n";
  const std::string mesh = "subsection Mesh\n  set Type = box\nend\n";

  TEST(Mistakes, one_is_told_as_it_is)
  {
    EXPECT_EQ(mistakes_in(sizes + mesh), "");
    EXPECT_EQ(mistakes_in(sizes + mesh + "set Steps = 0\n"),
              "case.prm:7: entry \"Steps\" = \"0\": allowed is a whole number of at least 1.");
  }

  TEST(Mistakes, all_are_told_in_the_order_of_the_file)
  {
    const std::string message =
        mistakes_in("set Stepps = 1\nsubsection Mesh\n  set Type = bax\nend\nset Steps = 0\n",
                    {"Parts = a, b, a", "none"});
    EXPECT_TRUE(contains(message, "8 mistakes were found:\n 1. case.prm:1: unknown entry "
                                  "\"Stepps\". Did you mean \"Steps\"?"));
    EXPECT_TRUE(contains(message, "\n 2. case.prm:3: entry \"Mesh/Type\" = \"bax\": allowed is"));
    EXPECT_TRUE(contains(message, "\n 3. case.prm:5: entry \"Steps\" = \"0\": allowed is"));
    for (const char *const piece :
         {"--set \"none\": \"=\" is missing.", "the name \"a\" stands twice.",
          "the entry \"Height\" is missing.", "the entry \"Radius\" is missing.",
          "the entry \"Length\" is missing."})
      EXPECT_TRUE(contains(message, piece));
  }

  TEST(Mistakes, what_only_follows_is_not_told)
  {
    // A value that was refused, or is missing, is not compared with others.
    for (const char *const height :
         {"set Height = high\n", "set Heigth = 1\n", "set Height 1\n", "Height = 3\n"})
    {
      const std::string message =
          mistakes_in(height + std::string("set Radius = 2\nset Length = 1\n") + mesh);
      EXPECT_TRUE(contains(message, "case.prm:1: "));
      EXPECT_FALSE(contains(message, "mistakes"));
    }
    EXPECT_TRUE(contains(mistakes_in("set Height = 1\nset Radius = 2\nset Length = 1\n" + mesh),
                         "case.prm:1: entry \"Height\" = \"1\": it is too low."));
    // A section that is not there has no missing entries, where another may be meant for it.
    EXPECT_FALSE(
        contains(mistakes_in(sizes + "subsection Mash\n  set Type = box\nend\n"), "mistakes"));
  }

  TEST(Mistakes, lines_are_read_as_they_seem_to_be_meant)
  {
    const std::string message = mistakes_in("sett Steps = 0\nsubsecton Mesh\n  set Type = box\n  "
                                            "set Type = disc\nend of it\nset Steps = 5\n" +
                                            sizes);
    EXPECT_TRUE(contains(message, "6 mistakes were found:\n 1. case.prm:1: a line begins"));
    for (const char *const piece :
         {"\n 2. case.prm:1: entry \"Steps\" = \"0\"", "\n 3. case.prm:2: a line begins",
          "\n 4. case.prm:4: entry \"Mesh/Type\" is set twice", "\n 5. case.prm:5: \"end\" stands",
          "\n 6. case.prm:6: entry \"Steps\" is set twice"})
      EXPECT_TRUE(contains(message, piece));
  }

  TEST(Mistakes, twenty_are_shown_and_the_others_counted)
  {
    std::string text = sizes + mesh;
    for (unsigned int i = 0; i < 30; ++i)
      text += "set Nonsense " + std::to_string(i) + " = 1\n";
    const std::string message = mistakes_in(text);
    EXPECT_TRUE(contains(message, "30 mistakes were found, of which these are the first 20:"));
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
    EXPECT_TRUE(contains(message, "\n20. case.prm:26: "));
  }

  TEST(Mistakes, an_override_without_a_value_takes_an_entry_back)
  {
    EXPECT_EQ(mistakes_in(sizes + mesh + "set Steps = 0\n", {"Steps ="}), "");
    EXPECT_TRUE(
        contains(mistakes_in(sizes + mesh, {"Height="}), "the entry \"Height\" is missing."));
    EXPECT_TRUE(contains(mistakes_in(sizes + mesh, {"Hight="}), "Did you mean \"Height\"?"));
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("set Parts = a, b\nset Steps = 7\n", "case.prm");
    parameters.add_override("Parts =");
    parameters.add_override("Steps =");
    EXPECT_TRUE(parameters.raw_list("Parts").empty());
    declare_shapes(parameters.handler());
    parameters.assign();
    EXPECT_EQ(parameters.section("").get_unsigned("Steps"), 10u);
    EXPECT_FALSE(parameters.section("").is_set("Steps"));
    parameters.section("").get("Parts");
    parameters.refuse_unused();
  }
} // namespace
