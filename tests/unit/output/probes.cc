// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/output/probes.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

#include "output/mock_scene.h"
#include "output_test_directory.h"
#include "text_testing.h"

using namespace tombolo;
using tombolo::testing::contains;
using tombolo::testing::input_error;

namespace
{
  template <int dim>
  std::string message_of(const std::string &text)
  {
    return input_error(
        [&]
        {
          const mock::Model<dim> model(1, 2, false);
          mock::OutputsOf<dim> outputs("set Write solution = false\nsubsection probes\n" + text +
                                       "end\n");
          outputs.outputs.at(0)->check(model.view(0, 0));
        });
  }

  /** What probes.csv holds after steps of 0.1 from 0 to 1. */
  template <int dim>
  std::string history(const std::string &text)
  {
    const mock::Model<dim> model(1, 2, false);
    mock::OutputsOf<dim> outputs("set Write solution = false\nsubsection probes\n" + text +
                                 "end\n");
    const TestDirectory test("probes");
    const OutputDirectory directory(test.path, MPI_COMM_WORLD);
    TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
    Output<dim> &probes = *outputs.outputs.at(0);
    probes.check(model.view(0, 0));
    probes.start(model.view(0, 0), directory, UnitLabels());
    double time = 0;
    for (unsigned int step = 0; step <= 10; ++step, time += 0.1)
    {
      probes.after_step(model.view(time, step));
      if (step == 5)
        probes.write(model.view(time, step), statistics);
    }
    Json results = Json::object();
    probes.finish(results);
    MPI_Barrier(MPI_COMM_WORLD);
    const std::string result = read_file(directory.file("probes.csv"));
    MPI_Barrier(MPI_COMM_WORLD);
    return result;
  }

  std::vector<std::string> lines_of(const std::string &text)
  {
    std::istringstream in(text);
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);)
      result.push_back(line);
    return result;
  }
} // namespace

TEST(Probes, rows_have_position_displacement_and_velocity_of_the_nearest_node)
{
  const auto lines = lines_of(history<2>("set Locations = tip: 3.9, 1.2; 1.2, 0\n"));
  ASSERT_EQ(lines.size(), 12u);
  EXPECT_EQ(lines[0],
            "time [T],step,tip position x [L],tip position y [L],tip displacement x [L],"
            "tip displacement y [L],tip velocity x [L/T],tip velocity y [L/T],"
            "probe 2 position x [L],probe 2 position y [L],probe 2 displacement x [L],"
            "probe 2 displacement y [L],probe 2 velocity x [L/T],probe 2 velocity y [L/T]");
  std::istringstream row(lines[1]);
  const double expected[] = {0, 0, 4.4, 1.1, 0.4, 0.1, 4, 2, 1.1, 0, 0.1, 0, 1, 2};
  for (const double value : expected)
  {
    std::string field;
    ASSERT_TRUE(std::getline(row, field, ','));
    EXPECT_NEAR(std::stod(field), value, 1e-14);
  }
}

TEST(Probes, rows_come_at_multiples_of_the_interval_or_of_steps)
{
  // 0.3, 0.6 and 0.9 are sums of rounded tenths; 0.25 lies between steps.
  const auto times = [](const std::string &text)
  {
    std::vector<std::string> steps;
    for (const std::string &line : lines_of(history<3>("set Locations = 0, 0, 0\n" + text)))
      if (line.find("time") == std::string::npos)
        steps.push_back(line.substr(line.find(',') + 1,
                                    line.find(',', line.find(',') + 1) - line.find(',') - 1));
    return steps;
  };
  EXPECT_EQ(times("set Interval = 0.3\n"), (std::vector<std::string>{"0", "3", "6", "9"}));
  EXPECT_EQ(times("set Interval = 0.25\n"), (std::vector<std::string>{"0", "3", "5", "8", "10"}));
  EXPECT_EQ(times("set Steps = 4\n"), (std::vector<std::string>{"0", "4", "8"}));
}

TEST(Probes, nodes_are_given_by_region_and_number)
{
  const auto names = [](const std::string &text)
  {
    std::vector<std::string> result;
    std::istringstream header(lines_of(history<2>(text))[0]);
    const std::string end = " position x [L]";
    for (std::string name; std::getline(header, name, ',');)
      if (name.find(end) != std::string::npos)
        result.push_back(name.substr(0, name.size() - end.size()));
    return result;
  };
  std::vector<std::string> region_names = names("set Where = x > 3.5 && y > 0.5\n");
  ASSERT_EQ(region_names.size(), 2u);
  const std::string row = lines_of(history<2>("set Where = x > 3.5 && y > 0.5\n"
                                              "set Columns = * position x\n"))[1];
  EXPECT_EQ(row, "0,0,4.4,4.4");

  const std::string second = region_names[1].substr(region_names[1].find(' ') + 1);
  std::swap(region_names[0], region_names[1]);
  EXPECT_EQ(names("set Nodes = " + second + "\nset Where = x > 3.5 && y > 0.5\n"), region_names);
  region_names.insert(region_names.begin(), "tip");
  region_names.pop_back();
  EXPECT_EQ(names("set Locations = tip: 4, 2\nset Nodes = " + second + "\n"), region_names);
}

TEST(Probes, nodes_that_are_not_there_are_refused)
{
  const auto refuses = [](const std::string &text, const std::string &words)
  {
    const std::string message = message_of<2>(text);
    EXPECT_TRUE(contains(message, words));
  };
  refuses("set Nodes = 123456789\n", "there is no node with the number 123456789");
  refuses("set Nodes = 1.5\n", "\"1.5\" is not the number of a node");
  refuses("set Nodes = 1, 1\n", "the node 1 is listed twice");
  refuses("set Where = x > 5\n", "there is no node beside those of `Nodes`");
}

TEST(Probes, columns_are_those_that_are_named)
{
  const std::string tip = "set Locations = tip: 3.9, 1.2; 1.2, 0\n";
  const auto lines =
      lines_of(history<2>(tip + "set Columns = tip velocity *, probe 2 position y\n"));
  EXPECT_EQ(lines[0], "time [T],step,tip velocity x [L/T],tip velocity y [L/T],"
                      "probe 2 position y [L]");
  EXPECT_EQ(std::count(lines[1].begin(), lines[1].end(), ','), 4);
  EXPECT_TRUE(contains(message_of<2>(tip + "set Columns = tip speed x\n"),
                       "probes.csv has no column \"tip speed x\""));
}

TEST(Probes, node_does_not_depend_on_ranks_where_several_are_equally_near)
{
  const mock::Model<3> model(1, 2, false);
  const TestDirectory test("probes_tie");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  mock::OutputsOf<3> outputs("set Write solution = false\nsubsection probes\n"
                             " set Locations = 1.5, 0.5, 0.5; 2, 0.5, 1\nend\n");
  auto *const probes = dynamic_cast<Probes<3> *>(outputs.outputs.at(0).get());
  ASSERT_NE(probes, nullptr);
  probes->check(model.view(0, 0));
  probes->start(model.view(0, 0), directory, UnitLabels());

  // The smallest identifier of the nodes at the corners of the cell, and of the edge's two ends.
  const auto smallest_id = [&](const std::vector<dealii::Point<3>> &points)
  {
    std::uint64_t id = std::numeric_limits<std::uint64_t>::max();
    for (unsigned int node = 0; node < model.state.partition()->n_owned(); ++node)
      for (const auto &point : points)
      {
        const double *const x = model.state.initial_position.node(node);
        if (point.distance(dealii::Point<3>(x[0], x[1], x[2])) < 1e-10)
          id = std::min(id, model.nodes->persistent_ids()[node]);
      }
    const auto id_of_rank = dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, id);
    return *std::min_element(id_of_rank.begin(), id_of_rank.end());
  };
  std::vector<dealii::Point<3>> corners;
  for (unsigned int i = 0; i < 8; ++i)
    corners.emplace_back(1. + (i & 1), (i >> 1) & 1, i >> 2);
  EXPECT_EQ(probes->nodes()[0], smallest_id(corners));
  EXPECT_EQ(probes->nodes()[1], smallest_id({{2, 0, 1}, {2, 1, 1}}));
}

TEST(Probes, unusable_locations_are_refused_with_their_place)
{
  const std::string outside = message_of<2>("set Locations = tip: 40, 1\n");
  EXPECT_TRUE(contains(outside, "output.prm:4"));
  EXPECT_TRUE(contains(outside, "(40, 1)"));
  EXPECT_TRUE(contains(outside, "outside of the body"));
  EXPECT_NE(message_of<3>("set Locations = 4, 1\n").find("has 2 coordinates; 3 are needed"),
            std::string::npos);
  EXPECT_TRUE(
      contains(message_of<2>("set Locations = 4, one\n"), "\"one\" in \"4, one\" is not a number"));
  EXPECT_NE(message_of<2>("set Locations = a: 0, 0; a: 1, 1\n").find("two probes are called \"a\""),
            std::string::npos);
  EXPECT_TRUE(contains(message_of<2>("set Locations = 0, 0\nset Steps = 2\nset Interval = 1\n"),
                       "only one of"));
}
