// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include "text_testing.h"

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace
{
  using namespace tombolo;
  using dealii::ParameterHandler;
  using tombolo::testing::contains;
  using tombolo::testing::input_error;
  namespace Patterns = dealii::Patterns;

  /** What a small program would declare. */
  void declare(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(handler, "End time", Patterns::Double(0.),
                                  "The time at which the run ends. Units: T.");
    handler.declare_entry("Parts", "", Patterns::Anything(), "Names of the parts.");
    handler.declare_entry("Title", "", Patterns::Anything(), "For pictures.");
    handler.declare_entry("Steps", "10", Patterns::Integer(1), "Number of steps.");
    handler.declare_entry("Quiet", "false", Patterns::Bool(), "No progress.");
    handler.declare_entry("Times", "", Patterns::List(Patterns::Double()), "Times of output.");
    handler.declare_alias("Steps", "Number of steps");
    handler.declare_alias("Quiet", "Silent", true);
    handler.enter_subsection("Mesh");
    handler.declare_entry("Type", "box", Patterns::Selection("box|cylinder|two discs"), "Which.");
    handler.enter_subsection("box");
    handler.declare_entry("Cells", "1, 1", Patterns::List(Patterns::Integer(1), 2, 3), "Cells.");
    handler.declare_entry("Spacing", "0.5", Patterns::Double(0., 2.), "Spacing.");
    handler.leave_subsection();
    handler.enter_subsection("cylinder");
    Parameters::declare_mandatory(handler, "Radius", Patterns::Double(), "Its radius.");
    handler.declare_entry("value", "1", Patterns::Double(), "A name that the handler mangles.");
    handler.leave_subsection();
    handler.leave_subsection();
    handler.enter_subsection("Part: layer 0.5");
    handler.declare_entry("Dilation", "1.8", Patterns::Double(), "Dilation, \"<a>\" & γ.");
    handler.leave_subsection();
  }

  /** The parameters of a text, assigned. */
  struct Assigned : Parameters
  {
    explicit Assigned(const std::string &text, const std::vector<std::string> &overrides = {})
        : Parameters(MPI_COMM_WORLD)
    {
      read_text(text, "case.prm");
      for (const auto &override : overrides)
        add_override(override);
      declare(handler());
      assign();
    }
  };

  std::string refusal(const std::string &text, const std::vector<std::string> &overrides = {})
  {
    return input_error([&] { Assigned parameters(text, overrides); });
  }

  std::string scanner_refusal(const std::string &text)
  {
    return input_error(
        [&]
        {
          Parameters parameters(MPI_COMM_WORLD);
          parameters.read_text(text, "case.prm");
        });
  }

  ::testing::AssertionResult begins_with(const std::string &text, const std::string &part)
  {
    if (text.compare(0, part.size(), part) == 0)
      return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "\"" << part << "\" is not the beginning of: " << text;
  }

  /** A directory with files, the same for all ranks, removed at the end. */
  class Files
  {
  public:
    Files()
        : directory(std::filesystem::current_path() /
                    ("parameters_" +
                     std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD))))
    {
      if (is_root())
        std::filesystem::create_directories(directory / "deep" / "common");
      MPI_Barrier(MPI_COMM_WORLD);
    }

    ~Files()
    {
      MPI_Barrier(MPI_COMM_WORLD);
      std::error_code error;
      if (is_root())
        std::filesystem::remove_all(directory, error);
      MPI_Barrier(MPI_COMM_WORLD);
    }

    void write(const std::string &name, const std::string &text) const
    {
      if (is_root())
        std::ofstream(directory / name, std::ios::binary) << text;
      MPI_Barrier(MPI_COMM_WORLD);
    }

    std::string path(const std::string &name) const
    {
      return (directory / name).string();
    }

    static std::string reading(const std::string &name)
    {
      return input_error(
          [&]
          {
            Parameters parameters(MPI_COMM_WORLD);
            parameters.read_file(name);
          });
    }

  private:
    static bool is_root()
    {
      return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    }

    std::filesystem::path directory;
  };

  TEST(Parameters, values_are_read_from_entries_sections_continuations_and_comments)
  {
    const Assigned parameters("# a comment\n"
                              "set End time = 2e1   # with a comment\r\n"
                              "set Title = one = \\\n"
                              "   two\n"
                              "set\tParts\t=\tleft ,  right\n"
                              "set Times = 1, 2.5,\\\n"
                              "  -3\n"
                              "subsection Mesh\n"
                              "  subsection box\n"
                              "    set Cells = 50, 6, 6\n"
                              "  end\n"
                              "end\n"
                              "subsection Part: layer 0.5\n"
                              "  set Dilation = 1.5\n"
                              "end");
    const Section root = parameters.section("");
    EXPECT_EQ(root.get_double("End time"), 20.);
    EXPECT_EQ(root.get("Title"), "one = two");
    EXPECT_EQ(root.get_list("Parts"), (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(parameters.raw_list("Parts"), (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(root.get_doubles("Times"), (std::vector<double>{1, 2.5, -3}));
    EXPECT_EQ(root.get_unsigned("Steps"), 10u);
    EXPECT_FALSE(root.get_bool("Quiet"));
    const Section box = root.subsection("Mesh").subsection("box");
    EXPECT_EQ(box.path(), "Mesh/box");
    EXPECT_EQ(box.get("Cells"), "50, 6, 6");
    EXPECT_TRUE(box.is_set("Cells"));
    EXPECT_FALSE(box.is_set("Spacing"));
    EXPECT_EQ(parameters.location("Mesh/box/Cells").line, 10u);
    EXPECT_EQ(parameters.location("Mesh/box/Cells").file, "case.prm");
    EXPECT_EQ(parameters.location("Mesh/box/Spacing").file, "");
    const Section part = parameters.section("Part: layer 0.5");
    EXPECT_EQ(part.name(), "layer 0.5");
    EXPECT_EQ(part.get_positive("Dilation"), 1.5);
    parameters.refuse_unused();
  }

  TEST(Parameters, unknown_entry_is_refused_with_place_nearest_name_and_all_known_names)
  {
    EXPECT_EQ(refusal("\nsubsection Mesh\n  subsection box\n    set Spacin = 1\n  end\nend\n"),
              "case.prm:4: unknown entry \"Mesh/box/Spacin\". Did you mean \"Spacing\"? Known "
              "entries of section \"Mesh/box\": \"Cells\", \"Spacing\".");
    EXPECT_TRUE(contains(refusal("set END TIME = 1\n"), "Did you mean \"End time\"?"));
    EXPECT_TRUE(contains(refusal("set Spacing = 1\n"),
                         "There is an entry of this name elsewhere: \"Mesh/box/Spacing\"."));
    EXPECT_TRUE(contains(refusal("set Mesh = 1\n"), "write \"subsection Mesh\""));
  }

  TEST(Parameters, unknown_section_is_refused_with_place_and_nearest_name)
  {
    const std::string message = refusal("subsection Mash\nend\n");
    EXPECT_TRUE(
        begins_with(message, "case.prm:1: unknown section \"Mash\". Did you mean \"Mesh\"?"));
    EXPECT_TRUE(contains(message, "Known sections: \"Mesh\", \"Part: layer 0.5\"."));
    EXPECT_TRUE(contains(refusal("subsection Part: other\nend\n"),
                         "needs its name, \"other\", in the list \"Parts\""));
    EXPECT_TRUE(contains(refusal("subsection Steps\nend\n"), "write \"set Steps = ...\""));
  }

  TEST(Parameters, unsuitable_value_is_refused_with_what_is_allowed)
  {
    EXPECT_EQ(refusal("set Steps = 0\n"),
              "case.prm:1: entry \"Steps\" = \"0\": allowed is a whole number of at least 1.");
    EXPECT_EQ(refusal("set Quiet = yep\n"),
              "case.prm:1: entry \"Quiet\" = \"yep\": allowed is \"true\" or \"false\".");
    EXPECT_EQ(refusal("subsection Mesh\nset Type = cilinder\nend\n"),
              "case.prm:2: entry \"Mesh/Type\" = \"cilinder\": allowed is one of \"box\", "
              "\"cylinder\", \"two discs\". Did you mean \"cylinder\"?");
    EXPECT_TRUE(contains(refusal("subsection Mesh\nsubsection box\nset Cells = 1\nend\nend"),
                         "allowed is a list, separated by commas, of 2 to 3 items, each of them a "
                         "whole number of at least 1."));
    EXPECT_TRUE(contains(refusal("subsection Mesh\nsubsection box\nset Spacing = 3\nend\nend"),
                         "allowed is a number from 0 to 2."));
    EXPECT_TRUE(
        contains(refusal("set Times = 1, two"), "any number of items, each of them a number"));
    EXPECT_TRUE(contains(refusal("set End time ="), "allowed is a number of at least 0."));
    for (const std::string value : {"nan", "inf", "1e999", "1 2", "0x", "1,5", "two"})
      EXPECT_TRUE(
          begins_with(refusal("set End time = " + value), "case.prm:1: entry \"End time\""));
    const std::string long_value(50000, 'a');
    EXPECT_LT(refusal("set Steps = " + long_value).size(), 400u);
  }

  TEST(Parameters, missing_mandatory_entry_is_refused_when_it_is_read)
  {
    const Assigned parameters("set Steps = 1\nsubsection Mesh\nset Type = box\nend\n");
    const std::string message =
        input_error([&] { parameters.section("Mesh/cylinder").get_double("Radius"); });
    EXPECT_TRUE(begins_with(message, "case.prm:2: section \"Mesh/cylinder\": the entry \"Radius\" "
                                     "is missing."));
    EXPECT_TRUE(contains(message, "Its radius."));
    EXPECT_TRUE(contains(message, "Allowed is a number."));
    const std::string at_root = input_error([&] { parameters.section("").get("End time"); });
    EXPECT_TRUE(begins_with(at_root, "case.prm: the entry \"End time\" is missing."));
  }

  TEST(Parameters, readers_refuse_with_place_entry_and_value)
  {
    const Assigned parameters("set Steps = 3\nset Title = -1\nset Parts = a,,b\n"
                              "subsection Part: layer 0.5\nset Dilation = -1\nend\n");
    const Section root = parameters.section("");
    EXPECT_EQ(input_error([&] { root.get_unsigned("Title"); }),
              "case.prm:2: entry \"Title\" = \"-1\": allowed is a whole number from 0 to "
              "4294967295.");
    EXPECT_EQ(input_error([&] { root.get_bool("Title"); }),
              "case.prm:2: entry \"Title\" = \"-1\": allowed is \"true\" or \"false\".");
    EXPECT_EQ(input_error([&] { root.get_positive("Title"); }),
              "case.prm:2: entry \"Title\" = \"-1\": allowed is a number larger than zero.");
    EXPECT_EQ(input_error([&] { root.get_double("Parts"); }),
              "case.prm:3: entry \"Parts\" = \"a,,b\": allowed is a number.");
    EXPECT_TRUE(contains(input_error([&] { root.get_list("Parts"); }), "an item is missing"));
    EXPECT_TRUE(contains(input_error([&] { parameters.raw_list("Parts"); }), "a name is missing"));
    EXPECT_EQ(input_error([&] { root.subsection("Mesh").subsection("box").fail("Cells", "no."); }),
              "case.prm: entry \"Mesh/box/Cells\" = \"1, 1\" (its default): no.");
    EXPECT_EQ(input_error([&] { root.subsection("Part: layer 0.5").fail("", "no."); }),
              "case.prm:4: section \"Part: layer 0.5\": no.");
    EXPECT_TRUE(
        contains(input_error([] { Assigned("set Parts = a, b, a").raw_list("Parts"); }),
                 "case.prm:1: entry \"Parts\" = \"a, b, a\": the name \"a\" stands twice."));
  }

  TEST(Parameters, doubled_entries_and_sections_are_refused_with_both_places)
  {
    EXPECT_EQ(scanner_refusal("set Steps = 1\n\nset Steps = 1\n"),
              "case.prm:3: entry \"Steps\" is set twice, here and at case.prm:1. Remove one of "
              "them.");
    EXPECT_EQ(scanner_refusal("subsection Mesh\nend\nsubsection Mesh\nend\n"),
              "case.prm:3: subsection \"Mesh\" stands twice, here and at case.prm:1. Put their "
              "entries into one.");
    EXPECT_TRUE(contains(refusal("set Steps = 1\nset Number of steps = 2\n"),
                         "case.prm:2: entry \"Number of steps\" is another name of \"Steps\""));
  }

  TEST(Parameters, another_name_of_an_entry_sets_it)
  {
    const Assigned parameters("set Number of steps = 7\n");
    EXPECT_EQ(parameters.section("").get_unsigned("Steps"), 7u);
    EXPECT_EQ(parameters.location("Steps").line, 1u);
    parameters.refuse_unused();
  }

  TEST(Parameters, only_a_former_name_of_an_entry_is_noted)
  {
    EXPECT_TRUE(Assigned("set Number of steps = 7\nset Quiet = true\n").renaming_notes().empty());
    const Assigned parameters("set End time = 1\nset Silent = true\n");
    EXPECT_TRUE(parameters.section("").get_bool("Quiet"));
    ASSERT_EQ(parameters.renaming_notes().size(), 1u);
    EXPECT_EQ(parameters.renaming_notes()[0],
              "case.prm:2: entry \"Silent\" is now called \"Quiet\".");
    EXPECT_EQ(Assigned("", {"Silent = true"}).renaming_notes().at(0),
              "--set \"Silent = true\": entry \"Silent\" is now called \"Quiet\".");
  }

  TEST(Parameters, malformed_text_is_refused_with_its_line)
  {
    EXPECT_TRUE(begins_with(scanner_refusal("subsection A\nsubsection B\nend\n"),
                            "case.prm:1: subsection \"A\" is not closed"));
    EXPECT_TRUE(begins_with(scanner_refusal("subsection A\nend\nend\n"), "case.prm:3: \"end\""));
    EXPECT_TRUE(
        begins_with(scanner_refusal("subsection A\nend A\n"), "case.prm:2: \"end\" stands"));
    EXPECT_TRUE(begins_with(scanner_refusal("subsection\n"), "case.prm:1: the name"));
    EXPECT_TRUE(begins_with(scanner_refusal("set A\n"), "case.prm:1: \"set\" without \"=\""));
    EXPECT_TRUE(begins_with(scanner_refusal("set = 1\n"), "case.prm:1: the name"));
    EXPECT_TRUE(begins_with(scanner_refusal("set\n"), "case.prm:1: \"set\" without"));
    EXPECT_TRUE(begins_with(scanner_refusal("include\n"), "case.prm:1: the name of the file"));
    EXPECT_TRUE(contains(scanner_refusal("\nSteps = 1\n"), "Did you mean \"set Steps = 1\"?"));
    EXPECT_TRUE(contains(scanner_refusal("\nsubsecton A\n"), "Did you mean \"subsection\"?"));
    EXPECT_TRUE(begins_with(scanner_refusal("set A/B = 1\n"), "case.prm:1: the name of entry"));
    EXPECT_TRUE(begins_with(scanner_refusal("subsection A/B\nend"), "case.prm:1: the name of sub"));
    EXPECT_TRUE(begins_with(scanner_refusal("set A = 1 \\\n"), "case.prm:1: the last line ends"));
    EXPECT_TRUE(begins_with(scanner_refusal("# a \\\nset A = 1"), "case.prm:1: this comment ends"));
  }

  TEST(Parameters, what_is_not_text_is_refused_with_its_line)
  {
    EXPECT_TRUE(begins_with(scanner_refusal(std::string("\nset A = \0\n", 10)),
                            "case.prm:2: this is not text: byte 0x00 at column 9"));
    EXPECT_TRUE(contains(scanner_refusal("set A = \xff"), "byte 0xff"));
    EXPECT_TRUE(contains(scanner_refusal("set A = \xc3"), "byte 0xc3"));
    EXPECT_TRUE(contains(scanner_refusal("\x7f"
                                         "ELF\x02\x01\x01"),
                         "case.prm:1: this is not text"));
    EXPECT_TRUE(contains(scanner_refusal("set A = " + std::string(200000, 'x')), "200008 char"));
    std::string many;
    for (unsigned int i = 0; i < 30; ++i)
      many += std::string(5000, 'x') + "\\\n";
    EXPECT_TRUE(contains(scanner_refusal(many + "x"), "and those that continue it"));
    EXPECT_EQ(scanner_refusal("\xef\xbb\xbfset A = γ ∇φ 😀\r\n"), "");

    // Bytes of a fixed linear congruence: whatever they are, they are refused or read, no more.
    std::uint32_t state = 1;
    for (unsigned int repetition = 0; repetition < 300; ++repetition)
    {
      std::string text = "subsection A\nset B = 1\ninclude x\\\nend # c\n";
      for (unsigned int change = 0; change < 4; ++change)
      {
        state = state * 1664525u + 1013904223u;
        text[(state >> 8) % text.size()] = static_cast<char>(state >> 24);
      }
      scanner_refusal(text);
    }
  }

  TEST(Parameters, override_takes_precedence_and_is_named_in_messages)
  {
    const Assigned parameters("set Steps = 5\n", {"Steps = 6", "Mesh / box/Spacing=2"});
    EXPECT_EQ(parameters.section("").get_unsigned("Steps"), 6u);
    EXPECT_EQ(parameters.section("Mesh/box").get_double("Spacing"), 2.);
    EXPECT_EQ(parameters.raw("Steps"), "6");
    EXPECT_EQ(parameters.location("Steps").file, "--set");
    EXPECT_EQ(input_error([&] { parameters.fail("Steps", "no."); }), "--set \"Steps = 6\": no.");

    EXPECT_EQ(refusal("", {"Steps = 0"}),
              "--set \"Steps = 0\": allowed is a whole number of at least 1.");
    EXPECT_TRUE(contains(refusal("", {"Mesh/Typ = box"}),
                         "--set \"Mesh/Typ = box\": unknown entry \"Mesh/Typ\". Did you mean"));
    EXPECT_TRUE(contains(refusal("", {"Mash/Type = box"}), "unknown section \"Mash\""));
    EXPECT_TRUE(contains(refusal("", {"Steps"}), "--set \"Steps\": \"=\" is missing."));
    EXPECT_TRUE(contains(refusal("", {" = 1"}), "a name is missing"));
    EXPECT_TRUE(contains(refusal("", {"Mesh//Type = 1"}), "a name is missing"));
    EXPECT_TRUE(contains(refusal("", {"Title = a # b"}), "no \"#\""));
    EXPECT_TRUE(
        contains(refusal("", {"Steps = 1", "Steps = 2"}), "already set by --set \"Steps = 1\""));
    // The entries of the file are still checked.
    EXPECT_TRUE(contains(refusal("set Steps = 0\n", {"Steps = 1"}), "case.prm:1"));
  }

  TEST(Parameters, entry_that_nothing_reads_is_refused_with_the_reason)
  {
    const Assigned parameters("set Steps = 1\nsubsection Mesh\n set Type = box\n subsection "
                              "cylinder\n  set Radius = 1\n  set value = 3\n end\nend\n");
    parameters.section("").get("Steps");
    parameters.section("Mesh").get("Type");
    const std::string message = input_error([&] { parameters.refuse_unused(); });
    EXPECT_TRUE(begins_with(message, "case.prm:5: entry \"Mesh/cylinder/Radius\" = \"1\" has no "
                                     "effect here: section \"Mesh/cylinder\" is read only with "
                                     "\"Mesh/Type\" = \"cylinder\", but it is \"box\" "
                                     "(case.prm:3)."));
    EXPECT_TRUE(contains(message, "2 entries have no effect"));
    parameters.section("Mesh/cylinder").get("Radius");
    EXPECT_TRUE(begins_with(input_error([&] { parameters.refuse_unused(); }),
                            "case.prm:6: entry \"Mesh/cylinder/value\" = \"3\" has no effect here: "
                            "nothing reads it"));
    EXPECT_EQ(parameters.section("Mesh/cylinder").get_double("value"), 3.);
    parameters.refuse_unused();

    const Assigned overridden("", {"Mesh/cylinder/Radius = 2"});
    EXPECT_TRUE(contains(input_error([&] { overridden.refuse_unused(); }),
                         "--set \"Mesh/cylinder/Radius = 2\" has no effect here"));
  }

  TEST(Parameters,
       an_included_file_may_have_the_section_of_a_choice_that_the_including_file_replaces)
  {
    const Files files;
    files.write("base.prm", "subsection Mesh\n set Type = cylinder\n subsection cylinder\n"
                            "  set Radius = 1\n end\nend\n");
    const auto unused = [&](const std::string &text, const std::vector<std::string> &overrides,
                            const std::string &file = "main.prm")
    {
      files.write("main.prm", "include base.prm\n" + text);
      files.write("outer.prm", "include main.prm\n");
      Parameters parameters(MPI_COMM_WORLD);
      parameters.read_file(files.path(file));
      for (const std::string &assignment : overrides)
        parameters.add_override(assignment);
      declare(parameters.handler());
      parameters.assign();
      parameters.section("Mesh").get("Type");
      return input_error([&] { parameters.refuse_unused(); });
    };
    const std::string other_type = "subsection Mesh\n set Type = box\n";
    EXPECT_EQ(unused(other_type + "end\n", {}), "");
    EXPECT_EQ(unused("", {"Mesh/Type = box"}), "");
    EXPECT_EQ(unused(other_type + "end\n", {}, "outer.prm"), "");
    EXPECT_TRUE(contains(unused("", {}), "base.prm:4"));
    EXPECT_TRUE(
        contains(unused(other_type + " subsection cylinder\n  set value = 3\n end\nend\n", {}),
                 "main.prm:5: entry \"Mesh/cylinder/value\" = \"3\" has no effect here"));
    EXPECT_TRUE(contains(unused("", {"Mesh/Type = box", "Mesh/cylinder/value = 2"}),
                         "--set \"Mesh/cylinder/value = 2\" has no effect here"));
  }

  TEST(Parameters, includes_are_relative_to_the_including_file_and_may_be_changed_after_them)
  {
    const Files files;
    files.write("main.prm", "include deep/base.prm\nset Steps = 4\n");
    files.write("deep/base.prm",
                "set Steps = 3\nsubsection Mesh\n  include common/mesh.prm\nend\n");
    files.write("deep/common/mesh.prm", "set Type = two discs\n");
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_file(files.path("main.prm"));
    declare(parameters.handler());
    parameters.assign();
    EXPECT_EQ(parameters.section("").get_unsigned("Steps"), 4u);
    EXPECT_EQ(parameters.section("Mesh").get("Type"), "two discs");
    EXPECT_EQ(parameters.location("Mesh/Type").file, files.path("deep/common/mesh.prm"));
    EXPECT_EQ(parameters.file_name(), files.path("main.prm"));
    EXPECT_TRUE(begins_with(parameters.original_text(), "include deep/base.prm\nset Steps = 4\n"));
    EXPECT_TRUE(contains(parameters.original_text(), "mesh.prm\nset Type = two discs\n"));
    parameters.refuse_unused();

    files.write("late.prm", "set Steps = 4\ninclude deep/base.prm\n");
    EXPECT_TRUE(
        contains(Files::reading(files.path("late.prm")),
                 "base.prm:1: entry \"Steps\" is already set at " + files.path("late.prm") + ":1"));
    files.write("open.prm", "subsection Mesh\ninclude closing.prm\n");
    files.write("closing.prm", "end\n");
    EXPECT_TRUE(begins_with(Files::reading(files.path("open.prm")),
                            files.path("closing.prm") + ":1: \"end\" without a subsection"));
  }

  TEST(Parameters, a_value_that_a_later_line_replaces_may_be_one_that_is_not_allowed)
  {
    const Files files;
    files.write("base.prm", "set Steps = 0\n");
    const auto steps_with = [&](const std::string &replacement)
    {
      files.write("main.prm", "include base.prm\nset Steps = " + replacement + "\n");
      Parameters parameters(MPI_COMM_WORLD);
      parameters.read_file(files.path("main.prm"));
      declare(parameters.handler());
      parameters.assign();
      return parameters.section("").get_unsigned("Steps");
    };
    EXPECT_EQ(steps_with("4"), 4u);
    EXPECT_TRUE(begins_with(input_error([&] { steps_with("-4"); }),
                            files.path("main.prm") + ":2: entry \"Steps\" = \"-4\""));
  }

  TEST(Parameters, number_of_includes_is_limited)
  {
    // Ten of ten of ten, and the files between them.
    const auto times_ten = [](const std::string &name)
    {
      std::string text;
      for (unsigned int k = 0; k < 10; ++k)
        text += "include " + name + "\n";
      return text;
    };
    const Files files;
    files.write("a.prm", times_ten("b.prm"));
    files.write("b.prm", times_ten("c.prm"));
    files.write("c.prm", times_ten("d.prm"));
    files.write("d.prm", "# nothing\n");
    EXPECT_TRUE(contains(Files::reading(files.path("a.prm")), "more than 1000 files are included"));
    EXPECT_FALSE(contains(Files::reading(files.path("b.prm")), "files are included"));
  }

  TEST(Parameters, circle_of_includes_is_refused)
  {
    const Files files;
    files.write("a.prm", "\ninclude deep/b.prm\n");
    files.write("deep/b.prm", "include ../deep/../a.prm\n");
    const std::string message = Files::reading(files.path("a.prm"));
    EXPECT_TRUE(begins_with(message, files.path("deep/b.prm") + ":1: a circle of includes: " +
                                         files.path("a.prm") + " -> "));
    files.write("c.prm", "include c.prm\n");
    EXPECT_TRUE(contains(Files::reading(files.path("c.prm")), "c.prm:1: a circle of includes"));
  }

  TEST(Parameters, file_that_cannot_be_read_is_refused_on_all_ranks)
  {
    const Files files;
    EXPECT_TRUE(contains(Files::reading(files.path("missing.prm")),
                         "missing.prm\" cannot be read: there is no such file."));
    EXPECT_TRUE(contains(Files::reading(files.path("deep")), "cannot be read: it is a directory."));
    EXPECT_TRUE(contains(Files::reading(""), "cannot be read"));
    EXPECT_TRUE(contains(Files::reading("/dev/zero"), "larger than 64 MB"));
    files.write("empty.prm", " \n\n");
    EXPECT_TRUE(contains(Files::reading(files.path("empty.prm")), "cannot be read: it is empty."));
    files.write("main.prm", "\ninclude deep/missing.prm\n");
    EXPECT_TRUE(begins_with(Files::reading(files.path("main.prm")),
                            files.path("main.prm") + ":2: the included file"));
  }

  /** Reads what a run with a box mesh reads. */
  void read_as_a_run(const Parameters &parameters)
  {
    const Section root = parameters.section("");
    for (const auto *entry : {"End time", "Parts", "Title", "Steps", "Quiet", "Times"})
      root.get(entry);
    root.subsection("Mesh").get("Type");
    for (const auto *entry : {"Cells", "Spacing"})
      root.subsection("Mesh/box").get(entry);
    root.subsection("Part: layer 0.5").get("Dilation");
  }

  std::string printed(const Parameters &parameters, const std::string &format,
                      const bool with_documentation)
  {
    std::ostringstream out;
    parameters.print(out, format, with_documentation);
    return out.str();
  }

  TEST(Parameters, printed_parameters_can_be_read_again_and_give_the_same_run)
  {
    for (const bool with_documentation : {false, true})
    {
      const Assigned first("set End time = 20\nset Title = γ \\\n = 3\nset Times = 1, 2\n",
                           {"Mesh/box/Spacing = 1.25"});
      read_as_a_run(first);
      const std::string text = printed(first, "prm", with_documentation);
      const Assigned second(text);
      read_as_a_run(second);
      second.refuse_unused();
      EXPECT_EQ(printed(second, "prm", with_documentation), text);
      EXPECT_EQ(printed(second, "json", false), printed(first, "json", false));
      EXPECT_EQ(second.section("").get("Title"), "γ = 3");
      EXPECT_EQ(second.section("Mesh/box").get_double("Spacing"), 1.25);
      EXPECT_EQ(contains(text, "The time at which the run ends."), with_documentation);
      EXPECT_EQ(contains(text, "# set Radius"), with_documentation);
    }
  }

  TEST(Parameters, list_of_all_entries_is_a_valid_file_that_sets_nothing)
  {
    Parameters all(MPI_COMM_WORLD);
    declare(all.handler());
    const std::string text = printed(all, "prm", true);
    EXPECT_TRUE(contains(text, "# Mandatory. The time at which the run ends. Units: T. Allowed: a "
                               "number of at least 0.\n# set End time =\n"));
    EXPECT_TRUE(contains(text, "    # Spacing. Allowed: a number from 0 to 2. Default: 0.5\n    # "
                               "set Spacing = 0.5\n"));
    const Assigned read_again(text);
    read_again.refuse_unused();
  }

  TEST(Parameters, json_has_readable_names_and_typed_values_of_what_the_run_used)
  {
    const Assigned parameters("set End time = .5\nset Title = \"a\\b\"\n");
    read_as_a_run(parameters);
    EXPECT_EQ(printed(parameters, "json", false), "{\n"
                                                  "  \"End time\": 0.5,\n"
                                                  "  \"Parts\": \"\",\n"
                                                  "  \"Title\": \"\\\"a\\\\b\\\"\",\n"
                                                  "  \"Steps\": 10,\n"
                                                  "  \"Quiet\": false,\n"
                                                  "  \"Times\": \"\",\n"
                                                  "  \"Mesh\": {\n"
                                                  "    \"Type\": \"box\",\n"
                                                  "    \"box\": {\n"
                                                  "      \"Cells\": \"1, 1\",\n"
                                                  "      \"Spacing\": 0.5\n"
                                                  "    }\n"
                                                  "  },\n"
                                                  "  \"Part: layer 0.5\": {\n"
                                                  "    \"Dilation\": 1.8\n"
                                                  "  }\n"
                                                  "}\n");
    EXPECT_TRUE(contains(printed(parameters, "xml", true), "<ParameterHandler>"));
    EXPECT_TRUE(contains(input_error([&] { printed(parameters, "yaml", true); }), "\"yaml\""));
  }

  TEST(Parameters, markdown_has_all_declarations_and_no_values)
  {
    const Assigned parameters("set End time = 20\nset Steps = 77\n");
    read_as_a_run(parameters);
    const std::string page = printed(parameters, "markdown", true);
    EXPECT_TRUE(contains(page, "\n## Outside of all sections\n\n| entry | default | allowed | "
                               "meaning |\n|---|---|---|---|\n| `End time` | mandatory | a number "
                               "of at least 0 | The time at which the run ends. Units: T. |\n"));
    EXPECT_TRUE(contains(page, "| `Steps` | `10` | a whole number of at least 1 | Number of steps. "
                               "Also read as `Number of steps`. |\n"));
    EXPECT_TRUE(contains(page, "\n### `Mesh/cylinder`\n"));
    EXPECT_TRUE(contains(page, "Dilation, \"\\<a>\" & γ."));
    EXPECT_FALSE(contains(page, "77"));
    EXPECT_FALSE(contains(page, "| `Number of steps` |"));
  }

  TEST(Parameters, long_values_are_shortened_in_messages_without_cutting_characters)
  {
    std::string text;
    for (unsigned int i = 0; i < 1000; ++i)
      text += "γ";
    const std::string shown = in_quotes(text);
    EXPECT_LT(shown.size(), 200u);
    EXPECT_EQ(input_error(
                  [&]
                  {
                    Parameters parameters(MPI_COMM_WORLD);
                    parameters.read_text("set A = " + shown, "case.prm");
                  }),
              "");
  }
} // namespace
