// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <deal.II/grid/grid_tools.h>

#include <tombolo/mesh/mesh_source.h>

#include <mesh_testing.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** A scene of which nothing but the meshes is read. */
  template <int dim>
  class JoinedScene
  {
  public:
    /** @p meshes are names and lines of their sections. */
    explicit JoinedScene(const std::vector<std::pair<std::string, std::string>> &meshes)
        : parameters(MPI_COMM_WORLD)
    {
      std::string list, sections;
      for (const auto &[name, lines] : meshes)
      {
        list += (list.empty() ? "" : ", ") + name;
        sections += "subsection Mesh: " + name + "\n" + lines + "end\n";
      }
      parameters.read_text("set Meshes = " + list + "\n" + sections, "scene.prm");
      declare_mesh_sources<dim>(parameters);
      parameters.assign();
    }

    std::unique_ptr<Mesh<dim>> create() const
    {
      auto mesh = std::make_unique<Mesh<dim>>(MPI_COMM_WORLD);
      mesh_source<dim>(parameters)->create(*mesh);
      return mesh;
    }

    Parameters parameters;
  };

  /** Lines of the section of a box. */
  std::string box(const std::string &upper_corner, const std::string &cells,
                  const std::string &further = "")
  {
    return "set Type = box\n" + further + "subsection box\nset Upper corner = " + upper_corner +
           "\nset Cells = " + cells + "\nend\n";
  }

  const std::string two_squares =
      "set Type = file\nsubsection file\nset File = " + source_directory() +
      "/tests/meshes/two_squares.msh\nend\n";

  /** Sizes of the cells by material ids, and of the faces by boundary ids, over all ranks. */
  template <int dim>
  std::array<std::map<unsigned int, double>, 2> sizes_by_ids(const Mesh<dim> &mesh)
  {
    std::array<std::map<unsigned int, double>, 2> result;
    std::vector<std::tuple<unsigned int, unsigned int, double>> here;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
    {
      if (!cell->is_locally_owned())
        continue;
      result[0][cell->material_id()] += cell->measure();
      for (const unsigned int f : cell->face_indices())
        if (cell->at_boundary(f))
          result[1][cell->face(f)->boundary_id()] += cell->face(f)->measure();
    }
    for (auto &sizes : result)
    {
      const auto all_sizes = dealii::Utilities::MPI::all_gather(
          MPI_COMM_WORLD, std::vector<std::pair<unsigned int, double>>(sizes.begin(), sizes.end()));
      sizes.clear();
      for (const auto &rank_sizes : all_sizes)
        for (const auto &[id, size] : rank_sizes)
          sizes[id] += size;
    }
    return result;
  }
} // namespace

TEST(JoinedMeshes, share_no_nodes_where_they_touch)
{
  const auto mesh = JoinedScene<3>({{"a", box("1, 1, 1", "2, 2, 2")},
                                    {"b", box("2, 1, 1", "2, 2, 2", "set Shift = 1, 0, 0\n")}})
                        .create();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 16u);
  EXPECT_NEAR(dealii::GridTools::volume(mesh->triangulation), 3., 1e-14);
  const Nodes<3> nodes(*mesh, 1);
  EXPECT_EQ(nodes.dof_handler().n_dofs(), 2u * 27u);
  // Nine pairs of nodes at one position.
  std::set<std::vector<double>> positions;
  for (const auto &node : nodes_by_id(nodes))
    positions.insert(node.second);
  EXPECT_EQ(positions.size(), 54u - 9u);

  const auto [volumes, areas] = sizes_by_ids(*mesh);
  EXPECT_NEAR(volumes.at(mesh->group_names.at("mesh a")), 1., 1e-14);
  EXPECT_NEAR(volumes.at(mesh->group_names.at("mesh b")), 2., 1e-14);
  EXPECT_EQ(areas.size(), 12u);
  for (const std::string end : {"min", "max"})
  {
    EXPECT_NEAR(areas.at(mesh->boundary_names.at("a.x " + end)), 1., 1e-14);
    EXPECT_NEAR(areas.at(mesh->boundary_names.at("b.x " + end)), 1., 1e-14);
    EXPECT_NEAR(areas.at(mesh->boundary_names.at("b.y " + end)), 2., 1e-14);
    EXPECT_EQ(mesh->boundary_names.count("x " + end), 0u);
  }
}

TEST(JoinedMeshes, are_refined_as_often_as_all_sources_are)
{
  const auto mesh = JoinedScene<2>({{"a", box("1, 1", "4, 4")},
                                    {"b", box("1, 1", "6, 6", "set Shift = 1, 0.25\n")}})
                        .create();
  EXPECT_EQ(mesh->triangulation.n_cells(0), 4u + 9u);
  EXPECT_EQ(mesh->triangulation.n_global_levels(), 2u);
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 16u + 36u);
  EXPECT_NEAR(sizes_by_ids(*mesh)[1].at(mesh->boundary_names.at("a.x max")), 1., 1e-14);
  EXPECT_NEAR(sizes_by_ids(*mesh)[1].at(mesh->boundary_names.at("b.y min")), 1., 1e-14);
}

TEST(JoinedMeshes, are_turned_about_a_point_and_then_shifted)
{
  const auto mesh =
      JoinedScene<3>({{"a", box("1, 2, 3", "1, 1, 1",
                                "set Rotation = 90\nset Rotation axis = 0, 0, 5\n"
                                "set Rotation point = 1, 0, 0\nset Shift = 0, 0, 10\n")}})
          .create();
  std::set<std::vector<double>> positions;
  for (const auto &node : nodes_by_id(Nodes<3>(*mesh, 1)))
    positions.insert(node.second);
  std::set<std::vector<double>> expected;
  for (const double x : {0., 1.})
    for (const double y : {0., 2.})
      for (const double z : {0., 3.})
        expected.insert({1. - y, x - 1., z + 10.});
  EXPECT_EQ(positions, expected);

  const auto plane = JoinedScene<2>({{"a", box("2, 1", "1, 1",
                                               "set Rotation = -90\n"
                                               "set Rotation point = 2, 0\n")}})
                         .create();
  positions.clear();
  for (const auto &node : nodes_by_id(Nodes<2>(*plane, 1)))
    positions.insert(node.second);
  EXPECT_EQ(positions, (std::set<std::vector<double>>{{2., 2.}, {2., 0.}, {3., 2.}, {3., 0.}}));
}

TEST(JoinedMeshes, have_names_of_their_sources_with_and_without_their_own)
{
  const auto mesh = JoinedScene<2>({{"base", box("2, 1", "2, 2", "set Shift = 0, -1\n")},
                                    {"of file", two_squares}})
                        .create();
  const auto [areas, lengths] = sizes_by_ids(*mesh);
  EXPECT_EQ(mesh->boundary_names.at("free edge"), mesh->boundary_names.at("of file.free edge"));
  EXPECT_NEAR(lengths.at(mesh->boundary_names.at("free edge")), 1., 1e-14);
  EXPECT_EQ(mesh->boundary_names.at("x min"), mesh->boundary_names.at("base.x min"));
  EXPECT_NEAR(lengths.at(mesh->boundary_names.at("x min")), 1., 1e-14);
  EXPECT_EQ(mesh->group_names.at("left square"), mesh->group_names.at("of file.left square"));
  EXPECT_NEAR(areas.at(mesh->group_names.at("left square")), 1., 1e-14);
  EXPECT_NEAR(areas.at(mesh->group_names.at("mesh base")), 2., 1e-14);
  EXPECT_EQ(mesh->joint_groups.at("mesh of file").size(), 2u);
  EXPECT_NEAR(areas.at(mesh->group_names.at("of file.material 2")), 1., 1e-14);
  ASSERT_EQ(mesh->remarks.size(), 2u); // of a cell that is turned round, and of a surface inside
  EXPECT_TRUE(contains(mesh->remarks[0], "Mesh \"of file\": 1 of 2 cells"));
  EXPECT_TRUE(contains(mesh->remarks[1], "Mesh \"of file\": The surface \"seam\""));
}

TEST(JoinedMeshes, keep_numbers_of_nodes)
{
  const JoinedScene<2> scene(
      {{"base", box("2, 1", "2, 2", "set Shift = 0, -1\n")}, {"of file", two_squares}});
  const auto numbers = mesh_source<2>(scene.parameters)->node_numbers();
  ASSERT_EQ(numbers.size(), 9u + 6u);
  for (unsigned int v = 0; v < 9; ++v)
    EXPECT_EQ(numbers[v], std::numeric_limits<long long>::min());
  EXPECT_EQ(std::vector<long long>(numbers.begin() + 9, numbers.end()),
            (std::vector<long long>{1, 2, 3, 4, 5, 6}));

  const JoinedScene<2> twice({{"one", two_squares}, {"two", "set Shift = 3, 0\n" + two_squares}});
  EXPECT_TRUE(contains(input_error([&] { mesh_source<2>(twice.parameters)->node_numbers(); }),
                       "the meshes \"one\" and \"two\" both have a node of the number 1"));
  EXPECT_TRUE(contains(twice.create()->remarks[0], "Mesh \"one\""));
  const auto remarks = twice.create()->remarks;
  EXPECT_EQ(std::count_if(remarks.begin(), remarks.end(),
                          [](const std::string &remark)
                          { return remark.find("have the number") != std::string::npos; }),
            2);
  EXPECT_TRUE(JoinedScene<2>({{"base", box("2, 1", "2, 2")}}).create()->remarks.empty());
  const JoinedScene<2> no_file({{"base", box("2, 1", "2, 2")}});
  EXPECT_TRUE(mesh_source<2>(no_file.parameters)->node_numbers().empty());
}

TEST(JoinedMeshes, may_touch_and_not_overlap)
{
  const auto error = [](const std::string &cells, const std::string &shift)
  {
    const JoinedScene<2> scene(
        {{"a", box("2, 2", "2, 2")}, {"b", box("1, 1", cells, "set Shift = " + shift + "\n")}});
    return input_error([&] { scene.create(); });
  };
  EXPECT_EQ(error("1, 1", "2, 1"), "");
  EXPECT_EQ(error("1, 1", "2, 1.3"), "");
  EXPECT_EQ(error("1, 1", "2, 2"), "");
  EXPECT_EQ(error("4, 4", "1.97, 1.97"), "");
  // No centre of a cell is in the other mesh.
  const std::string overlap = "the meshes \"a\" and \"b\" overlap: the cell of the first one at ";
  EXPECT_TRUE(contains(error("1, 1", "1.6, 1.6"),
                       overlap + "(1.5, 1.5) goes into a cell of the other one"));
  EXPECT_TRUE(contains(error("1, 1", "1.25, 1"), overlap + "(1.5, 1.5)"));
  // Small cells at the edge of a large one.
  EXPECT_TRUE(contains(error("4, 4", "1.75, 1"), overlap + "(1.5, 1.5)"));
  EXPECT_TRUE(contains(error("1, 1", "-0.25, -0.25"), overlap + "(0.5, 0.5)"));
}
