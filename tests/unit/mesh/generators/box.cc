// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <deal.II/grid/grid_tools.h>

#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/mesh_source.h>

#include <mesh_testing.h>

#include <algorithm>
#include <cmath>
#include <set>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const std::string rod = "set Upper corner = 10, 1.2, 1.2\nset Cells = 50, 6, 6\n";

  /** Different values of a coordinate among the nodes. Refined ones are means of others and may
   * differ in their last digit, which is rounded off. */
  template <int dim>
  std::set<double> coordinates(const Mesh<dim> &mesh, const unsigned int axis)
  {
    const Nodes<dim> nodes(mesh, 1);
    std::set<double> result;
    for (const auto &node : nodes_by_id(nodes))
      result.insert(std::round(node.second[axis] * 1e12) / 1e12);
    return result;
  }

  template <int dim>
  std::string error_of(const std::string &entries)
  {
    return input_error([&]() { MeshScene<dim>("box", entries).create_mesh(); });
  }
} // namespace

TEST(Box, is_refined_from_the_coarsest_box_its_counts_allow)
{
  const auto mesh = MeshScene<3>("box", rod).create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 1800u);
  EXPECT_EQ(mesh->triangulation.n_cells(0), 25u * 3u * 3u);
  EXPECT_EQ(mesh->triangulation.n_global_levels(), 2u);
  EXPECT_NEAR(dealii::GridTools::volume(mesh->triangulation) / 14.4, 1, 1e-12);

  const auto square =
      MeshScene<2>("box", "set Upper corner = 1, 2\nset Cells = 48, 16").create_mesh();
  EXPECT_EQ(square->triangulation.n_cells(0), 3u);
  EXPECT_EQ(square->triangulation.n_global_active_cells(), 768u);
}

TEST(Box, divides_an_axis_into_segments_of_their_own_spacing)
{
  const auto mesh = MeshScene<3>("box", "set Upper corner = 10, 1.2, 1.2\n"
                                        "set Cells = 4 to 5 | 12 to 10; 2; 2")
                        .create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 64u);
  EXPECT_EQ(mesh->triangulation.n_cells(0), 8u);
  const auto x = coordinates(*mesh, 0);
  ASSERT_EQ(x.size(), 17u);
  EXPECT_EQ(*std::next(x.begin(), 1), 1.25);
  EXPECT_EQ(*std::next(x.begin(), 4), 5.);
  EXPECT_NEAR(*std::next(x.begin(), 5), 5. + 5. / 12, 1e-12);
  EXPECT_EQ(*x.rbegin(), 10.);

  // An odd count in one segment: no refinement, and the last segment needs no end.
  const auto odd = MeshScene<2>("box", "set Lower corner = -1, -2\nset Upper corner = 1, 2\n"
                                       "set Cells = 3 to 0 | 2; 2 to -1 | 4 to 1 | 2 to 2")
                       .create_mesh();
  EXPECT_EQ(odd->triangulation.n_cells(0), 40u);
  EXPECT_EQ(coordinates(*odd, 1), (std::set<double>{-2, -1.5, -1, -.5, 0, .5, 1, 1.5, 2}));
}

TEST(Box, names_its_boundaries)
{
  const MeshScene<3> model("box", rod);
  const auto mesh = model.create_mesh();
  const std::vector<std::string> names = {"x min", "x max", "y min", "y max", "z min", "z max"};
  ASSERT_EQ(mesh->boundary_names.size(), 6u);
  std::map<dealii::types::boundary_id, double> area;
  for (const auto &cell : mesh->triangulation.active_cell_iterators())
    if (cell->is_locally_owned())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
        {
          const auto id = cell->face(f)->boundary_id();
          area[id] += cell->face(f)->measure();
          for (unsigned int b = 0; b < 6; ++b)
          {
            const double end = b % 2 == 0 ? 0 : (b == 1 ? 10 : 1.2);
            const bool is_there = std::abs(cell->face(f)->center()[b / 2] - end) < 1e-12;
            EXPECT_EQ(mesh->boundary_names.at(names[b]) == id, is_there);
          }
        }
  for (unsigned int b = 0; b < 6; ++b)
    EXPECT_NEAR(
        dealii::Utilities::MPI::sum(area[mesh->boundary_names.at(names[b])], MPI_COMM_WORLD),
        b < 2 ? 1.44 : 12, 1e-12);
}

TEST(Box, disorder_is_the_same_on_any_number_of_ranks)
{
  const MeshScene<3> model("box", "set Upper corner = 3, 2, 2\nset Cells = 6, 4, 4\n"
                                  "set Disorder = 0.2");
  const auto mesh = model.create_mesh();
  const auto alone = model.create_mesh(MPI_COMM_SELF);
  EXPECT_EQ(mesh->triangulation.n_global_levels(), 1u);
  EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 1)), nodes_by_id(Nodes<3>(*alone, 1)));
  mesh->triangulation.repartition();
  EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 1)), nodes_by_id(Nodes<3>(*alone, 1)));
}

TEST(Box, disorder_moves_inner_nodes_by_its_fraction_and_leaves_the_surface)
{
  const std::string box = "set Upper corner = 4, 4\nset Cells = 8, 8\n";
  const auto regular =
      nodes_by_id(Nodes<2>(*MeshScene<2>("box", box + "set Disorder = 1e-12").create_mesh(), 1));
  const auto disordered =
      nodes_by_id(Nodes<2>(*MeshScene<2>("box", box + "set Disorder = 0.2").create_mesh(), 1));
  const auto sliding = nodes_by_id(Nodes<2>(
      *MeshScene<2>("box", box + "set Disorder = 0.2\nset Surface nodes = slide").create_mesh(),
      1));
  const auto other = nodes_by_id(
      Nodes<2>(*MeshScene<2>("box", box + "set Disorder = 0.2\nset Seed = 1").create_mesh(), 1));
  double largest = 0;
  double sum = 0;
  unsigned int n_slid = 0;
  for (const auto &[id, position] : regular)
  {
    bool is_inside = true;
    for (unsigned int d = 0; d < 2; ++d)
    {
      const double move = disordered.at(id)[d] - position[d];
      largest = std::max(largest, std::abs(move));
      sum += move;
      const bool at_end = std::abs(position[d]) < 1e-9 || std::abs(position[d] - 4) < 1e-9;
      is_inside = is_inside && !at_end;
      if (at_end)
        EXPECT_NEAR(sliding.at(id)[d], position[d], 1e-11);
      else if (std::abs(sliding.at(id)[d] - position[d]) > 1e-6)
        ++n_slid;
    }
    if (is_inside)
      EXPECT_NE(disordered.at(id), other.at(id));
    else
      for (unsigned int d = 0; d < 2; ++d)
        EXPECT_NEAR(disordered.at(id)[d], position[d], 1e-11);
  }
  EXPECT_LE(largest, 0.2 * 0.5);
  EXPECT_GT(largest, 0.15 * 0.5);
  EXPECT_LT(std::abs(sum / (2 * 49)), 0.02);
  EXPECT_EQ(n_slid, 2u * 49u + 4u * 7u);
}

TEST(Box, is_turned_about_an_axis)
{
  const auto mesh = MeshScene<2>("box", "set Upper corner = 10, 1\nset Cells = 4, 2\n"
                                        "set Rotation = 30")
                        .create_mesh();
  double largest = 0;
  for (const auto &node : nodes_by_id(Nodes<2>(*mesh, 1)))
    largest = std::max(largest, node.second[0] * std::sqrt(3.) / 2 + node.second[1] / 2);
  EXPECT_NEAR(largest, 10, 1e-13);
  EXPECT_NEAR(dealii::GridTools::volume(mesh->triangulation), 10, 1e-12);

  const auto solid = MeshScene<3>("box", "set Upper corner = 1, 2, 3\nset Cells = 1, 1, 1\n"
                                         "set Rotation = 120\nset Rotation axis = 2, 2, 2")
                         .create_mesh();
  // A third of a turn about the diagonal maps x to y, y to z, and z to x.
  for (unsigned int d = 0; d < 3; ++d)
    EXPECT_NEAR(*coordinates(*solid, (d + 1) % 3).rbegin(), d + 1, 1e-14);
}

TEST(Box, refuses_what_makes_no_box)
{
  const std::string corner = "set Upper corner = 10, 1.2, 1.2\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"set Upper corner = 10, 0, 1\nset Cells = 1, 1, 1", "The extent along y is 0"},
      {"set Upper corner = 10, -1, 1\nset Cells = 1, 1, 1", "The extent along y is -1"},
      {"set Lower corner = 11, 0, 0\n" + rod, "The extent along x is -1"},
      {corner + "set Cells = 50, 0, 6", "There are 0 cells along y"},
      {corner + "set Cells = 50, -6, 6", "\"-6\" is not a number of cells along y"},
      {corner + "set Cells = 50, 6.5, 6", "\"6.5\" is not a number of cells along y"},
      {corner + "set Cells = 50, 6", "This is for 2 axes, and the scene has 3"},
      {corner + "set Cells = 25 to 5 | 25 to 4; 6; 6", "ends at 4 and begins at 5"},
      {corner + "set Cells = 25 to 5 | 25 to 11; 6; 6", "outside the box, which ends at 10"},
      {corner + "set Cells = 25 to 5 | 25 to 9; 6; 6", "end at 9, and the box at 10"},
      {corner + "set Cells = 25 | 25 to 10; 6; 6", "does not say where it ends"},
      {corner + "set Cells = 25 to nan; 6; 6", "\"nan\" is not a coordinate along x"},
      {corner + "set Cells = 25 to five | 25; 6; 6", "\"five\" is not a coordinate along x"},
      {corner + "set Cells = 12345678901, 6, 6", "too many"},
      {corner + "set Cells = 999999999, 999999999, 999999999", "nodes. At most"},
      {corner + "set Cells = 1001, 1001, 1001", "coarse cells of about 2 kB each"},
      {rod + "set Rotation axis = 0, 0, 0", "must be finite and not zero"},
      {"set Upper corner = 1, 1, 1\nset Cells = 20, 20, 20\nset Disorder = 0.49",
       "is turned inside out by this disorder"},
  };
  for (const auto &[entries, message] : cases)
  {
    const std::string error = error_of<3>(entries);
    EXPECT_TRUE(contains(error, message));
    EXPECT_TRUE(contains(error, "scene.prm:"));
  }
  // Refused by the pattern of the entry or by the box: the entry is named in any case.
  for (const std::string entries : {"set Upper corner = nan, 1, 1\nset Cells = 1, 1, 1",
                                    "set Upper corner = inf, 1, 1\nset Cells = 1, 1, 1",
                                    "set Upper corner = 1, 1\nset Cells = 1, 1, 1",
                                    "set Cells = 1, 1, 1", "set Upper corner = 1, 1, 1"})
    EXPECT_TRUE(contains(error_of<3>(entries), "Mesh/box")) << entries;
  for (const std::string entry : {"Disorder = -0.1", "Disorder = 0.6", "Rotation = nan"})
    EXPECT_TRUE(contains(error_of<3>(rod + "set " + entry), "scene.prm:5")) << entry;
}

TEST(BoundaryNames, are_found_and_unknown_ones_refused_with_the_nearest)
{
  Parameters parameters(MPI_COMM_WORLD);
  parameters.read_text("set Good = x min, z max\nset Bad = x mim\n", "names.prm");
  for (const char *entry : {"Good", "Bad"})
    parameters.handler().declare_entry(entry, "", dealii::Patterns::Anything());
  parameters.assign();
  const auto mesh = MeshScene<3>("box", rod).create_mesh();
  const Section root = parameters.section("");
  EXPECT_EQ(boundary_ids(*mesh, root, "Good"), (std::set<dealii::types::boundary_id>{0, 5}));

  mesh->remarks.push_back("The surface \"x mim\" is somewhere else.");
  const std::string error = input_error([&]() { boundary_ids(*mesh, root, "Bad"); });
  for (const char *part :
       {"names.prm:2", "no boundary \"x mim\"", "mean \"x min\"", "\"y max\"", "is somewhere else"})
    EXPECT_TRUE(contains(error, part));
}
