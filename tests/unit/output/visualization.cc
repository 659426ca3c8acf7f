// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/output/visualization.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "output/mock_scene.h"
#include "output_test_directory.h"
#include "text_testing.h"

using namespace tombolo;
using tombolo::testing::contains;
using tombolo::testing::input_error;

namespace
{
  std::size_t count_of(const std::string &text, const std::string &part)
  {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
      ++n;
    return n;
  }

  /** The attributes of each array between two tags, in order. */
  std::vector<std::string> arrays_between(const std::string &text, const std::string &tag)
  {
    const std::size_t begin = text.find("<" + tag), end = text.find("</" + tag);
    std::vector<std::string> result;
    for (std::size_t at = text.find("DataArray type", begin); at < end;
         at = text.find("DataArray type", at + 1))
    {
      const std::size_t close = std::min(text.find(" format", at), text.find("/>", at));
      result.push_back(text.substr(at, close - at));
    }
    return result;
  }
} // namespace

TEST(Visualization, every_rank_writes_a_piece_with_the_arrays_that_the_whole_announces)
{
  const TestDirectory test("visualization_pieces");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);

  // One cell of particles: on several ranks, some have none.
  const mock::Model<3> model(1, 3, true);
  mock::OutputsOf<3> outputs("");
  ASSERT_EQ(outputs.outputs.size(), 1u);
  outputs.outputs[0]->start(model.view(0, 0), directory, UnitLabels());
  outputs.outputs[0]->write(model.view(0, 0), statistics);
  MPI_Barrier(MPI_COMM_WORLD);

  for (const std::string kind : {"cells", "particles"})
  {
    const std::string whole = read_file(directory.file("solution/" + kind + "_0000.pvtu"));
    EXPECT_EQ(count_of(whole, "<Piece "), n_ranks);
    for (unsigned int rank = 0; rank < n_ranks; ++rank)
    {
      const std::string name = kind + "_0000.000" + std::to_string(rank) + ".vtu";
      EXPECT_EQ(count_of(whole, "\"" + name + "\""), 1u) << whole;
      const std::string piece = read_file(directory.file("solution/" + name));
      for (const std::string data : {"PointData", "CellData", "Points"})
        EXPECT_EQ(arrays_between(piece, data), arrays_between(whole, "P" + data)) << data;
    }
    EXPECT_EQ(count_of(whole, "Name=\"exact stress\" NumberOfComponents=\"6\" "
                              "ComponentName0=\"xx\""),
              1u)
        << whole;
  }
}

TEST(Visualization, scene_of_one_kind_writes_no_files_of_the_other)
{
  const TestDirectory test("visualization_one_kind");
  const OutputDirectory directory(test.path, MPI_COMM_WORLD);
  TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
  const mock::Model<2> model(1, 2, false);
  mock::OutputsOf<2> outputs("");
  OutputView<2> view = model.view(0, 0);
  view.parts[0] = view.parts[1];
  outputs.outputs[0]->start(view, directory, UnitLabels());
  outputs.outputs[0]->write(view, statistics);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TRUE(std::filesystem::exists(directory.file("solution/particles_0000.pvtu")));
  EXPECT_FALSE(std::filesystem::exists(directory.file("solution/cells_0000.pvtu")));
  EXPECT_EQ(count_of(read_file(directory.file("solution.pvd")), "<DataSet"), 1u);
}

TEST(Visualization, can_be_switched_off)
{
  EXPECT_TRUE(mock::OutputsOf<2>("set Write solution = false\n").outputs.empty());
}

TEST(Outputs, unknown_output_is_refused_with_the_nearest_name)
{
  const std::string message =
      input_error([] { mock::OutputsOf<2> outputs("set Further outputs = visualisation\n"); });
  for (const std::string part : {"output.prm:2", "did you mean \"visualization\"?",
                                 "probes, rigid body history, section history, visualization"})
    EXPECT_TRUE(contains(message, part));
}

TEST(VtuPiece, cells_of_degree_p_become_p_to_the_dim_linear_ones_with_common_points)
{
  const mock::Model<3> model(2, 2, false);
  const VtuPiece piece = make_cell_piece(model.view(0, 0), PictureFields());
  EXPECT_EQ(piece.n_cells(), 8u * model.elements->n_cells());
  if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
  {
    EXPECT_EQ(piece.n_points(), 5u * 5u * 5u);
  }
}

TEST(VtuPiece, array_of_wrong_size_is_refused)
{
  VtuPiece piece(1, 1, false);
  piece.points = {0, 0, 0};
  piece.connectivity = {0};
  piece.point_data.add("short", "1", 3, {1., 2.});
  std::ostringstream out;
  EXPECT_ANY_THROW(piece.write(out, 0.));
}

TEST(VtuPiece, empty_piece_names_its_arrays_and_holds_no_values)
{
  VtuPiece piece(12, 8, false);
  piece.cell_data.add("stress", "M/(L T^2)", 6, {});
  std::ostringstream out;
  piece.write(out, 0.);
  EXPECT_EQ(count_of(out.str(), "NumberOfPoints=\"0\" NumberOfCells=\"0\""), 1u);
  EXPECT_EQ(count_of(out.str(), "type=\"Float32\" Name=\"stress\" NumberOfComponents=\"6\""), 1u);
}
