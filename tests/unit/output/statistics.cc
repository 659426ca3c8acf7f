// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/log.h>
#include <tombolo/output/time_table.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "output_test_directory.h"
#include "text_testing.h"

using namespace tombolo;
using tombolo::testing::contains;
using tombolo::testing::input_error;

namespace
{
  UnitLabels labels_of(const std::string &text)
  {
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("set Unit labels = " + text + "\n", "test.prm");
    declare<UnitLabels>(parameters.handler());
    parameters.assign();
    return UnitLabels(parameters.section(""));
  }

  std::string message_of_labels(const std::string &text)
  {
    return input_error([&] { labels_of(text); });
  }

  void serialize(TimeTable &table, StateArchive &archive)
  {
    Records records;
    table.list(records);
    records.serialize(archive);
  }
} // namespace

TEST(TimeTable, table_has_a_header_with_units_and_a_row_per_output)
{
  const TestDirectory test("statistics_table");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  statistics.open(directory, labels_of("length: mm, mass: t, time: s, stress: MPa"));
  for (const double time : {0., 0.5})
  {
    statistics.add("time", "T", time);
    statistics.add("step", "1", 1000000. * time);
    statistics.add("largest stress", "M/(L T^2)", 1. / 3);
    statistics.add("momentum", "M L/T", -2);
    statistics.write_row();
  }
  EXPECT_EQ(read_file(directory.file("statistics.csv")),
            "time [s],step,largest stress [MPa],momentum [t mm/s]\n"
            "0,0,0.3333333333333333,-2\n"
            "0.5,500000,0.3333333333333333,-2\n");
  EXPECT_EQ(statistics.column("time"), (std::vector<double>{0, 0.5}));
}

TEST(UnitLabels, force_stress_energy_and_power_follow_from_known_units)
{
  const UnitLabels millimetres = labels_of("length: mm, mass: t, time: s");
  EXPECT_EQ(millimetres.label("M L/T^2"), "N");
  EXPECT_EQ(millimetres.label("M/(L T^2)"), "MPa");
  EXPECT_EQ(millimetres.label("M L^2/T^2"), "mJ");
  EXPECT_EQ(millimetres.label("M L^2/T^3"), "mW");
  EXPECT_EQ(millimetres.heading("mean torque x", "M L^2/T^2"), "mean torque x [mN m]");
  EXPECT_EQ(millimetres.heading("angular momentum x", "M L^2/T"), "angular momentum x [t mm^2/s]");
  const UnitLabels milliseconds = labels_of("length: mm, mass: kg, time: ms");
  EXPECT_EQ(milliseconds.label("M L/T^2"), "kN");
  EXPECT_EQ(milliseconds.label("M/(L T^2)"), "GPa");
  EXPECT_EQ(milliseconds.label("M L^2/T^2"), "J");
  // A unit that is set holds; without known units, or a name for them, the label is a product.
  EXPECT_EQ(labels_of("length: mm, mass: t, time: s, stress: N/mm^2").label("M/(L T^2)"), "N/mm^2");
  EXPECT_EQ(labels_of("length: in, mass: slinch, time: s").label("M L/T^2"), "slinch in/s^2");
  EXPECT_EQ(labels_of("length: cm, mass: g, time: s").label("M L/T^2"), "g cm/s^2");
}

TEST(TimeTable, each_row_is_in_the_file_when_it_is_written)
{
  const TestDirectory test("statistics_flush");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  statistics.open(directory, UnitLabels());
  for (unsigned int row = 1; row <= 3; ++row)
  {
    statistics.add("row", "1", row);
    statistics.write_row();
    const std::string text = read_file(directory.file("statistics.csv"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), row + 1);
    MPI_Barrier(MPI_COMM_WORLD); // all have read before the next row is written
  }
}

TEST(TimeTable, late_column_leaves_earlier_rows_empty_and_so_does_a_missing_value)
{
  const TestDirectory test("statistics_late");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  statistics.open(directory, UnitLabels());
  statistics.add("a", "L", 1);
  statistics.write_row();
  statistics.add("a", "L", 2);
  statistics.add("b, of \"c\"", "1", 3);
  statistics.write_row();
  statistics.add("b, of \"c\"", "1", 4);
  statistics.write_row();
  EXPECT_EQ(read_file(directory.file("statistics.csv")),
            "a [L],\"b, of \"\"c\"\"\"\n1,\n2,3\n,4\n");
  EXPECT_TRUE(std::isnan(statistics.column("b, of \"c\"")[0]));
}

TEST(TimeTable, row_that_was_begun_and_not_written_is_forgotten)
{
  const TestDirectory test("statistics_forgotten");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  statistics.open(directory, UnitLabels());
  statistics.begin_row();
  statistics.add("time", "T", 0.);
  statistics.write_row();
  statistics.begin_row();
  statistics.add("time", "T", 1.);
  statistics.add("energy", "1", std::numeric_limits<double>::infinity());
  statistics.begin_row();
  statistics.add("time", "T", 2.);
  statistics.write_row();
  EXPECT_EQ(statistics.column("time"), (std::vector<double>{0., 2.}));
  EXPECT_EQ(read_file(directory.file("statistics.csv")), "time [T],energy\n0,\n2,\n");
}

TEST(TimeTable, two_values_in_a_row_or_two_units_are_refused)
{
  const TestDirectory test("statistics_twice");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  statistics.open(directory, UnitLabels());
  statistics.add("a", "L", 1);
  EXPECT_ANY_THROW(statistics.add("a", "L", 1));
  EXPECT_ANY_THROW(statistics.add("a", "T", 1));
}

TEST(TimeTable, checkpoint_with_columns_of_other_lengths_is_refused)
{
  const TestDirectory test("statistics_lengths");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  for (const std::string wrong : {"", "units", "values", "is given"})
  {
    const std::string file = directory.file("checkpoint" + wrong);
    const auto entries = [&](const std::string &name, const std::size_t n)
    { return n - (name == wrong ? 1 : 0); };
    {
      StateArchive archive(file, StateArchive::Mode::write, MPI_COMM_WORLD);
      const auto group = archive.group("table.csv");
      std::size_t n_rows = 2;
      std::vector<std::string> names(2, "a"), units(entries("units", 2), "1");
      std::vector<double> values(entries("values", 4), 1.);
      std::vector<std::uint64_t> given(entries("is given", 4), 1);
      archive("rows", n_rows);
      archive("names", names);
      archive("units", units);
      archive("values", values);
      archive("is given", given);
      archive.close();
    }
    StateArchive archive(file, StateArchive::Mode::read, MPI_COMM_WORLD);
    TimeTable statistics("table.csv", TimeTable::Rows::in_memory);
    if (wrong.empty())
      EXPECT_NO_THROW(serialize(statistics, archive));
    else
      EXPECT_THROW(serialize(statistics, archive), InputError) << wrong;
  }
}

TEST(TimeTable, rows_in_the_file_are_there_after_a_flush_and_have_the_columns_of_the_first_one)
{
  const TestDirectory test("table_in_file");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable table("table.csv", TimeTable::Rows::in_file);
  table.add("time", "T", 7.);
  table.add("a, b", "L", 7.);
  table.open(directory, labels_of("length: mm"));
  const std::string header = "time [T],\"a, b [mm]\"\n";
  EXPECT_EQ(read_file(directory.file("table.csv")), header);
  MPI_Barrier(MPI_COMM_WORLD); // all have read before rows are written
  table.add("a, b", "L", 0.5);
  table.add("time", "T", 1.);
  table.write_row();
  table.add("time", "T", 2.);
  EXPECT_ANY_THROW(table.add("c", "1", 3.));
  table.write_row();
  table.flush();
  EXPECT_EQ(read_file(directory.file("table.csv")), header + "1,0.5\n2,\n");
  EXPECT_TRUE(table.column("time").empty());
}

TEST(TimeTable, rows_in_the_file_end_at_the_checkpoint_where_a_run_is_resumed)
{
  const TestDirectory test("table_resumed");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  const std::string checkpoint = directory.file("checkpoint");
  {
    TimeTable table("table.csv", TimeTable::Rows::in_file);
    table.add("time", "T", 0.);
    table.open(directory, UnitLabels());
    for (const double time : {1., 2.})
    {
      table.add("time", "T", time);
      table.write_row();
      if (time == 1.)
      {
        StateArchive archive(checkpoint, StateArchive::Mode::write, MPI_COMM_WORLD);
        serialize(table, archive);
        archive.close();
      }
    }
    table.flush();
  }
  const auto resume = [&](const std::string &column)
  {
    TimeTable table("table.csv", TimeTable::Rows::in_file);
    EXPECT_FALSE(table.is_continued());
    {
      StateArchive archive(checkpoint, StateArchive::Mode::read, MPI_COMM_WORLD);
      serialize(table, archive);
    }
    EXPECT_TRUE(table.is_continued());
    table.add(column, "T", 0.);
    EXPECT_EQ(table.has_other_columns(UnitLabels()), column != "time");
    table.open(directory, UnitLabels());
    table.add(column, "T", 3.);
    table.write_row();
    table.flush();
  };
  EXPECT_EQ(read_file(directory.file("table.csv")), "time [T]\n1\n2\n");
  EXPECT_THROW(resume("clock"), InputError);
  resume("time");
  EXPECT_EQ(read_file(directory.file("table.csv")), "time [T]\n1\n3\n");
}

TEST(TimeTable, numbers_read_back_as_the_same_double)
{
  for (const double value : {0.1, 1. / 3, 1e-300, 1.7976931348623157e308, 123456789., -1e15, 1e22})
    EXPECT_EQ(std::stod(format_number(value)), value);
  EXPECT_EQ(format_number(1000000), "1000000");
  EXPECT_EQ(format_number(std::nan("")), "nan");
  EXPECT_EQ(format_number(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(UnitLabels, names_are_put_into_derived_units)
{
  const UnitLabels labels = labels_of("length: mm, mass: t, time: s");
  EXPECT_EQ(labels.label("M/L^3"), "t/mm^3");
  EXPECT_EQ(labels.heading("strain", "1"), "strain");
  EXPECT_EQ(labels_of("").heading("stress", "M/(L T^2)"), "stress [M/(L T^2)]");
}

TEST(UnitLabels, unknown_quantity_is_refused_with_the_nearest_name)
{
  const std::string message = message_of_labels("lenght: mm");
  EXPECT_TRUE(contains(message, "test.prm:1"));
  EXPECT_TRUE(contains(message, "\"length\""));
  EXPECT_TRUE(contains(message_of_labels("length = mm"), "quantity: name"));
  EXPECT_TRUE(contains(message_of_labels("time: s, time: ms"), "twice"));
}

TEST(OutputDirectory, place_that_cannot_be_written_is_refused_with_entry_and_place)
{
  const TestDirectory test("directory_refused");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  directory.write("file", [](std::ostream &out) { out << "x"; });

  const auto message_for = [](const std::string &path)
  {
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_text("\nset Output directory = " + path + "\n", "test.prm");
    parameters.handler().declare_entry("Output directory", "output");
    parameters.assign();
    return input_error(
        [&]
        { OutputDirectory refused(parameters.section(""), "Output directory", MPI_COMM_WORLD); });
  };
  const std::string is_file = message_for(directory.file("file"));
  EXPECT_TRUE(contains(is_file, "test.prm:2"));
  EXPECT_TRUE(contains(is_file, "Output directory"));
  EXPECT_TRUE(contains(is_file, "is a file"));
  EXPECT_TRUE(
      contains(message_for(directory.file("file/below")), "there can be no directory in it"));
  // Not even root can create a directory here.
  EXPECT_TRUE(contains(message_for("/proc/tombolo_output"), "cannot create"));
}

TEST(OutputDirectory, file_that_fails_leaves_the_former_one_and_throws_on_every_rank)
{
  const TestDirectory test("directory_atomic");
  const OutputDirectory directory(test.path + "/a/b", MPI_COMM_WORLD);
  directory.write("file", [](std::ostream &out) { out << "first"; });
  EXPECT_THROW(directory.write("file",
                               [](std::ostream &out)
                               {
                                 out << "half of the sec";
                                 out.setstate(std::ios::failbit);
                               }),
               RunError);
  EXPECT_EQ(read_file(directory.file("file")), "first");
  EXPECT_FALSE(std::filesystem::exists(directory.file("file.tmp")));

  const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const unsigned int last = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) - 1;
  EXPECT_THROW(directory.write_pieces("piece" + std::to_string(rank),
                                      [&](std::ostream &out)
                                      {
                                        if (rank == last)
                                          out.setstate(std::ios::failbit);
                                      }),
               RunError);
}

TEST(OutputDirectory, only_results_of_an_earlier_run_are_removed)
{
  const TestDirectory test("directory_clean");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  directory.create_subdirectory("solution");
  const std::vector<std::string> removed = {"summary.json",
                                            "solution.pvd",
                                            "solution/cells_0001.0.vtu",
                                            "solution/particles_0001.pvtu",
                                            "probes.csv",
                                            "statistics.csv",
                                            "conditions.csv",
                                            "contact.csv",
                                            "parts.csv",
                                            "specimen.csv"};
  const std::vector<std::string> kept = {"log.txt", "my_table.csv", "solution/my_cells_0001.vtu",
                                         "solution/cells_0001.png"};
  for (const auto &names : {removed, kept})
    for (const std::string &name : names)
      directory.write(name, [](std::ostream &out) { out << "x"; });
  directory.remove_earlier_results();
  for (const std::string &name : removed)
    EXPECT_FALSE(std::filesystem::exists(directory.file(name))) << name;
  for (const std::string &name : kept)
    EXPECT_TRUE(std::filesystem::exists(directory.file(name))) << name;
}

TEST(Log, rank_0_prints_to_screen_and_file_what_was_said_before_the_file_too)
{
  const TestDirectory test("log");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  std::ostringstream screen;
  {
    Log log(MPI_COMM_WORLD, false, screen, false);
    log.print("early");
    log.open_file(directory);
    log.print("late");
    log.warn("beware");
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string text = "early\nlate\nWarning: beware\n";
  EXPECT_EQ(screen.str(),
            dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0 ? text : "");
  EXPECT_EQ(read_file(directory.file("log.txt")), text);
}

TEST(Log, progress_is_redrawn_on_a_terminal_and_a_line_per_output_elsewhere)
{
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    return;
  const auto screen_text = [](const bool quiet, const bool terminal)
  {
    std::ostringstream screen;
    {
      Log log(MPI_COMM_SELF, quiet, screen, terminal);
      log.start_progress(1000, 0., 8.);
      log.progress({1., 10, 0.1, "energy", 1e-5}, false);
      log.progress({2., 20, 0.1, "energy", 1e-5}, true);
      log.print("text");
      log.progress({4., 40, 0.1, "energy", 1e-5}, true);
    }
    return screen.str();
  };
  const std::string pipe = screen_text(false, false);
  EXPECT_EQ(std::count(pipe.begin(), pipe.end(), '\n'), 3) << pipe;
  EXPECT_TRUE(contains(pipe, " 25.0 %  t = 2  step 20  "));
  EXPECT_EQ(pipe.find('\r'), std::string::npos);

  const std::string terminal = screen_text(false, true);
  EXPECT_EQ(std::count(terminal.begin(), terminal.end(), '\n'), 2) << terminal;
  EXPECT_TRUE(contains(terminal, "\r\x1b[Ktext\n"));
  EXPECT_TRUE(contains(terminal, "\r 50.0 %"));

  EXPECT_EQ(screen_text(true, true), "text\n");
  EXPECT_EQ(screen_text(true, false), "text\n");
}

TEST(Log, progress_of_a_resumed_run_counts_the_whole)
{
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    return;
  std::ostringstream screen;
  Log log(MPI_COMM_SELF, false, screen, false);
  log.start_progress(1000, 4., 8., 40);
  log.progress({4., 40, 0.1, "energy", 1e-5}, true);
  log.progress({6., 60, 0.1, "energy", 1e-5}, true);
  EXPECT_TRUE(contains(screen.str(), " 50.0 %  t = 4  step 40  "));
  EXPECT_TRUE(contains(screen.str(), " 75.0 %  t = 6  step 60  "));
}

TEST(Log, long_times_without_an_output_have_lines_of_their_own)
{
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    return;
  const auto n_lines = [](const bool quiet, const std::chrono::milliseconds time_between_lines)
  {
    std::ostringstream screen;
    {
      Log log(MPI_COMM_SELF, quiet, screen, false, time_between_lines);
      log.start_progress(1000, 0., 8.);
      for (const std::uint64_t step : {1, 2, 3})
        log.progress({0.1 * static_cast<double>(step), step, 0.1, "energy", 1e-5}, false);
    }
    const std::string text = screen.str();
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_EQ(n_lines(false, std::chrono::milliseconds(0)), 3);
  EXPECT_EQ(n_lines(false, std::chrono::minutes(1)), 0);
  EXPECT_EQ(n_lines(true, std::chrono::milliseconds(0)), 0);
}

TEST(Log, durations_are_written_as_clocks_show_them)
{
  EXPECT_EQ(format_duration(5), "0:05");
  EXPECT_EQ(format_duration(760), "12:40");
  EXPECT_EQ(format_duration(10931), "3:02:11");
  EXPECT_EQ(format_duration(std::nan("")), "?");
}
