// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <deal.II/base/numbers.h>
#include <deal.II/grid/grid_tools.h>

#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/cell_quality.h>

#include <mesh_testing.h>

#include <algorithm>
#include <cmath>
#include <set>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  constexpr double pi = dealii::numbers::PI;

  const std::string bar = "set Radius = 3.8\nset Length = 25.4\nset Core cells = 6\n"
                          "set Rings = 3\nset Cells along axis = 24\n";
  const std::string plate = "set Radius = 9\nset Thickness = 1.5\nset Core cells = 20\n"
                            "set Rings = 3 to 3.2 | 5 to 5 | 9 to 9\n";

  /** The area of a regular polygon of @p n corners on the circle. */
  double polygon_area(const unsigned int n, const double radius)
  {
    return 0.5 * n * radius * radius * std::sin(2 * pi / n);
  }

  template <int dim>
  std::set<std::vector<double>> node_positions(const Mesh<dim> &mesh)
  {
    std::set<std::vector<double>> result;
    for (const auto &node : nodes_by_id(Nodes<dim>(mesh, 1)))
      EXPECT_TRUE(result.insert(node.second).second) << "two nodes at one place";
    return result;
  }

  /** The areas of the boundaries by name, of flat faces exactly. */
  std::map<std::string, double> boundary_areas(const Mesh<3> &mesh)
  {
    std::map<dealii::types::boundary_id, double> area;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
            area[cell->face(f)->boundary_id()] +=
                0.5 * cross_product_3d(cell->face(f)->vertex(3) - cell->face(f)->vertex(0),
                                       cell->face(f)->vertex(2) - cell->face(f)->vertex(1))
                          .norm();
    std::map<std::string, double> result;
    for (const auto &[name, id] : mesh.boundary_names)
    {
      result[name] = dealii::Utilities::MPI::sum(area[id], MPI_COMM_WORLD);
      area.erase(id);
    }
    EXPECT_TRUE(area.empty()) << "a boundary without a name";
    return result;
  }

  template <int dim>
  double smallest_scaled_jacobian(const Mesh<dim> &mesh)
  {
    double smallest = 1;
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
      {
        CellVertices<dim> vertices;
        for (const unsigned int v : cell->vertex_indices())
          vertices[v] = cell->vertex(v);
        smallest = std::min(smallest, smallest_corner<dim>(vertices));
      }
    return dealii::Utilities::MPI::min(smallest, MPI_COMM_WORLD);
  }

  template <int dim>
  std::string error_of(const std::string &source, const std::string &entries)
  {
    return input_error([&]() { MeshScene<dim>(source, entries).create_mesh(); });
  }
} // namespace

TEST(Cylinder, has_the_counts_volume_and_boundary_areas_of_its_polygon)
{
  const auto mesh = MeshScene<3>("cylinder", bar).create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), (36u + 72u) * 24u);
  EXPECT_EQ(Nodes<3>(*mesh, 1).dof_handler().n_dofs(), (49u + 72u) * 25u);
  EXPECT_NEAR(dealii::GridTools::volume(mesh->triangulation) / (polygon_area(24, 3.8) * 25.4), 1,
              1e-12);
  const auto area = boundary_areas(*mesh);
  ASSERT_EQ(area.size(), 3u);
  EXPECT_NEAR(area.at("foot") / polygon_area(24, 3.8), 1, 1e-12);
  EXPECT_NEAR(area.at("rear") / polygon_area(24, 3.8), 1, 1e-12);
  EXPECT_NEAR(area.at("side") / (24 * 2 * 3.8 * std::sin(pi / 24) * 25.4), 1, 1e-12);
}

TEST(Cylinder, volume_converges_to_the_exact_one_with_second_order)
{
  std::vector<double> errors;
  for (const unsigned int n : {4, 8, 16})
  {
    const std::string entries = "set Radius = 1\nset Length = 2\nset Cells along axis = 2\n"
                                "set Core cells = " +
                                std::to_string(n) + "\nset Rings = " + std::to_string(n / 2) + "\n";
    const auto mesh = MeshScene<3>("cylinder", entries).create_mesh();
    errors.push_back(1 - dealii::GridTools::volume(mesh->triangulation) / (2 * pi));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.02);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.005);
}

TEST(Cylinder, cells_keep_their_shape_at_the_corners_of_the_core)
{
  for (const auto &[core, rings] : std::vector<std::pair<unsigned int, unsigned int>>{
           {2, 1}, {6, 2}, {6, 3}, {14, 8}, {16, 7}, {20, 5}, {20, 1}})
  {
    const std::string entries = "set Radius = 3.8\nset Length = 1\nset Cells along axis = 1\n"
                                "set Core cells = " +
                                std::to_string(core) + "\nset Rings = " + std::to_string(rings) +
                                "\n";
    const auto mesh = MeshScene<3>("cylinder", entries).create_mesh();
    EXPECT_GT(smallest_scaled_jacobian(*mesh), core == 2 ? 0.79 : 0.84)
        << core << " core cells, " << rings << " rings";
  }
}

TEST(Cylinder, half_and_quarter_are_restrictions_of_the_full_mesh)
{
  const auto full = node_positions(*MeshScene<3>("cylinder", bar).create_mesh());
  const std::vector<std::pair<std::string, std::set<unsigned int>>> cases = {
      {"x", {0}}, {"y", {1}}, {"x, y", {0, 1}}};
  for (const auto &[planes, axes] : cases)
  {
    const auto mesh =
        MeshScene<3>("cylinder", bar + "set Symmetry planes = " + planes).create_mesh();
    std::set<std::vector<double>> expected;
    for (const auto &position : full)
      if (std::all_of(axes.begin(), axes.end(),
                      [position = position](const unsigned int d) { return position[d] >= 0; }))
        expected.insert(position);
    EXPECT_EQ(node_positions(*mesh), expected) << planes;
    const double share = axes.size() == 1 ? 0.5 : 0.25;
    EXPECT_EQ(static_cast<double>(mesh->triangulation.n_global_active_cells()), share * 2592);

    const auto area = boundary_areas(*mesh);
    ASSERT_EQ(area.size(), 3 + axes.size());
    EXPECT_NEAR(area.at("foot") / polygon_area(24, 3.8), share, 1e-12);
    EXPECT_NEAR(area.at("side") / (24 * 2 * 3.8 * std::sin(pi / 24) * 25.4), share, 1e-12);
    for (const unsigned int d : axes)
    {
      const std::string name = std::string("symmetry ") + "xyz"[d];
      EXPECT_NEAR(area.at(name), (axes.size() == 1 ? 2 : 1) * 3.8 * 25.4, 1e-10) << name;
      for (const auto &cell : mesh->triangulation.active_cell_iterators())
        for (const unsigned int f : cell->face_indices())
          if (!cell->is_artificial() && cell->face(f)->at_boundary() &&
              cell->face(f)->boundary_id() == mesh->boundary_names.at(name))
          {
            for (unsigned int v = 0; v < 4; ++v)
              EXPECT_EQ(cell->face(f)->vertex(v)[d], 0.);
          }
    }
  }
}

TEST(Cylinder, lies_along_any_axis_from_its_foot)
{
  for (const unsigned int axis : {0u, 1u, 2u})
  {
    const std::string name(1, "xyz"[axis]);
    const std::string other(1, "xyz"[(axis + 1) % 3]);
    const auto mesh =
        MeshScene<3>("cylinder", bar + "set Axis = " + name + "\nset Foot = 1, 2, 3\n" +
                                     "set Symmetry planes = " + other)
            .create_mesh();
    EXPECT_GT(smallest_scaled_jacobian(*mesh), 0.7);
    EXPECT_EQ(mesh->boundary_names.count("symmetry " + other), 1u);
    std::vector<double> lowest(3, 1e9), highest(3, -1e9);
    for (const auto &position : node_positions(*mesh))
      for (unsigned int d = 0; d < 3; ++d)
      {
        lowest[d] = std::min(lowest[d], position[d]);
        highest[d] = std::max(highest[d], position[d]);
      }
    for (unsigned int d = 0; d < 3; ++d)
    {
      const double foot = d + 1.;
      const bool is_cut = d == (axis + 1) % 3;
      EXPECT_NEAR(lowest[d], d == axis || is_cut ? foot : foot - 3.8, 1e-12);
      EXPECT_NEAR(highest[d], d == axis ? foot + 25.4 : foot + 3.8, 1e-12);
    }
  }
}

TEST(Cylinder, layers_and_rings_are_graded)
{
  const auto mesh = MeshScene<3>("cylinder", "set Radius = 4\nset Length = 10\nset Core cells = 2\n"
                                             "set Rings = 1 to 2 | 3 to 4 ratio 0.25\n"
                                             "set Cells along axis = 4 to 2 | 3 ratio 4\n")
                        .create_mesh();
  std::set<double> heights, radii;
  for (const auto &position : node_positions(*mesh))
  {
    heights.insert(position[2]);
    if (position[1] == 0)
      radii.insert(position[0]);
  }
  const std::vector<double> expected = {0, 0.5, 1, 1.5, 2, 2 + 8. / 7, 2 + 24. / 7, 10};
  ASSERT_EQ(heights.size(), expected.size());
  auto height = heights.begin();
  for (const double value : expected)
    EXPECT_NEAR(*height++, value, 1e-13);
  auto radius = radii.rbegin();
  for (const double value : {4., 4 - 2. / 7, 4 - 6. / 7, 2.})
    EXPECT_NEAR(*radius++, value, 1e-13);
}

TEST(Cylinder, nodes_have_the_same_numbers_on_any_number_of_ranks)
{
  const MeshScene<3> model("cylinder", bar);
  const auto mesh = model.create_mesh();
  const auto alone = model.create_mesh(MPI_COMM_SELF);
  EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 1)), nodes_by_id(Nodes<3>(*alone, 1)));
  mesh->triangulation.repartition();
  EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 2)), nodes_by_id(Nodes<3>(*alone, 2)));
}

TEST(Disc, has_the_cells_and_nodes_of_the_drilled_plate)
{
  const auto mesh = MeshScene<3>("disc", plate + "set Cells through thickness = 6\n").create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 10560u);
  unsigned int within_3_2 = 0;
  unsigned int within_5 = 0;
  const auto nodes = node_positions(*mesh);
  EXPECT_EQ(nodes.size(), 7u * 1801u);
  for (const auto &position : nodes)
  {
    const double radius = std::hypot(position[0], position[1]);
    within_3_2 += radius < 3.2 + 1e-9;
    within_5 += radius < 5 + 1e-9;
  }
  EXPECT_EQ(within_3_2, 4767u);
  EXPECT_EQ(within_5, 7567u);
  EXPECT_GT(smallest_scaled_jacobian(*mesh), 0.7);
  for (const char *name : {"lower face", "upper face", "side"})
    EXPECT_EQ(mesh->boundary_names.count(name), 1u) << name;
}

TEST(Disc, of_two_dimensions_is_the_section)
{
  std::set<std::vector<double>> section;
  for (const auto &position : node_positions(
           *MeshScene<3>("disc", plate + "set Cells through thickness = 1\n").create_mesh()))
    section.insert({position[0], position[1]});
  const std::string flat = "set Radius = 9\nset Core cells = 20\n"
                           "set Rings = 3 to 3.2 | 5 to 5 | 9 to 9\n";
  const auto mesh = MeshScene<2>("disc", flat).create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 1760u);
  EXPECT_EQ(node_positions(*mesh), section);
  EXPECT_GT(smallest_scaled_jacobian(*mesh), 0.7);

  const auto quarter =
      MeshScene<2>("disc", flat + "set Symmetry planes = x, y\nset Position = 1, 2").create_mesh();
  EXPECT_EQ(quarter->triangulation.n_global_active_cells(), 440u);
  std::map<dealii::types::boundary_id, double> length;
  for (const auto &cell : quarter->triangulation.active_cell_iterators())
    if (cell->is_locally_owned())
      for (const unsigned int f : cell->face_indices())
        if (cell->face(f)->at_boundary())
        {
          length[cell->face(f)->boundary_id()] += cell->face(f)->measure();
          for (unsigned int d = 0; d < 2; ++d)
            if (cell->face(f)->boundary_id() ==
                quarter->boundary_names.at(d == 0 ? "symmetry x" : "symmetry y"))
            {
              EXPECT_EQ(cell->face(f)->center()[d], d + 1.);
            }
        }
  for (const char *name : {"side", "symmetry x", "symmetry y"})
    EXPECT_NEAR(
        dealii::Utilities::MPI::sum(length[quarter->boundary_names.at(name)], MPI_COMM_WORLD),
        name[1] == 'i' ? 40 * 9 * std::sin(pi / 80) : 9, 1e-12)
        << name;
}

TEST(Disc, cells_of_two_dimensions_see_common_edges_in_one_direction)
{
  // Nodes inside of an edge, of elements of degree three, would be exchanged otherwise.
  for (const std::string core_cells : {"1", "2", "5"})
  {
    const auto mesh =
        MeshScene<2>("disc", "set Radius = 1\nset Rings = 2\nset Core cells = " + core_cells)
            .create_mesh();
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      for (const unsigned int line : cell->line_indices())
        EXPECT_EQ(cell->line(line)->vertex_index(0),
                  cell->vertex_index(dealii::GeometryInfo<2>::line_to_cell_vertices(line, 0)));
  }
}

TEST(SphericalShell, has_the_counts_and_boundaries_of_an_octant)
{
  const auto mesh =
      MeshScene<3>("spherical shell", "set Inner radius = 80\nset Outer radius = 100\n"
                                      "set Cells along edge = 8\n"
                                      "set Cells through thickness = 5 ratio 1.25")
          .create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 3u * 16u * 5u);
  EXPECT_GT(smallest_scaled_jacobian(*mesh), 0.8);
  const auto area = boundary_areas(*mesh);
  ASSERT_EQ(area.size(), 5u);
  EXPECT_NEAR(area.at("inner") / (pi / 2 * 80 * 80), 1, 0.01);
  EXPECT_NEAR(area.at("outer") / (pi / 2 * 100 * 100), 1, 0.01);
  for (const char *name : {"symmetry x", "symmetry y", "symmetry z"})
    EXPECT_NEAR(area.at(name), (polygon_area(32, 100) - polygon_area(32, 80)) / 4, 1e-9) << name;
  for (const auto &cell : mesh->triangulation.active_cell_iterators())
    for (const unsigned int f : cell->face_indices())
      if (!cell->is_artificial() && cell->face(f)->at_boundary())
        for (unsigned int v = 0; v < 4; ++v)
        {
          const auto id = cell->face(f)->boundary_id();
          const auto &vertex = cell->face(f)->vertex(v);
          for (unsigned int d = 0; d < 3; ++d)
            if (id == mesh->boundary_names.at(std::string("symmetry ") + "xyz"[d]))
            {
              EXPECT_EQ(vertex[d], 0.);
            }
          if (id == mesh->boundary_names.at("inner"))
          {
            EXPECT_NEAR(vertex.norm(), 80, 1e-12);
          }
          if (id == mesh->boundary_names.at("outer"))
          {
            EXPECT_NEAR(vertex.norm(), 100, 1e-12);
          }
        }
}

TEST(SphericalShell, volume_converges_to_the_exact_one_with_second_order)
{
  std::vector<double> errors;
  for (const char *n : {"4", "8", "16"})
  {
    const auto mesh =
        MeshScene<3>("spherical shell",
                     std::string("set Inner radius = 1\nset Outer radius = 2\n"
                                 "set Cells through thickness = 2\nset Cells along edge = ") +
                         n)
            .create_mesh();
    errors.push_back(1 - dealii::GridTools::volume(mesh->triangulation) / (7 * pi / 6));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.05);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.02);
}

TEST(RoundMeshes, refuse_what_makes_no_mesh)
{
  const std::string disc = plate + "set Cells through thickness = 6\n";
  const std::string shell = "set Inner radius = 1\nset Outer radius = 2\n";
  struct Case
  {
    const char *source;
    std::string entries;
    const char *message;
  };
  const auto with = [](std::string entries, const std::string &name, const std::string &value)
  {
    const auto begin = entries.find("set " + name + " =");
    const auto end = entries.find('\n', begin);
    return entries.replace(begin, end - begin, "set " + name + " = " + value);
  };
  const std::vector<Case> cases = {
      {"cylinder", with(bar, "Radius", "0"), "Mesh/cylinder/Radius"},
      {"cylinder", with(bar, "Radius", "-1"), "Mesh/cylinder/Radius"},
      {"cylinder", with(bar, "Length", "0"), "Mesh/cylinder/Length"},
      {"cylinder", with(bar, "Core cells", "0"), "Mesh/cylinder/Core cells"},
      {"cylinder", with(bar, "Core cells", "7") + "set Symmetry planes = x",
       "must be even with `Symmetry planes`"},
      {"cylinder", with(bar, "Core cells", "3000"), "at most 4000000"},
      {"cylinder", with(bar, "Rings", "0"), "There are 0 cells in the rings"},
      {"cylinder", with(bar, "Rings", "-3"), "\"-3\" is not a number of cells in the rings"},
      {"cylinder", with(bar, "Rings", "3 to 4"), "outside the cylinder, which ends at 3.8"},
      {"cylinder", with(bar, "Rings", "3 to 2"), "end at 2, and the cylinder at 3.8"},
      {"cylinder", with(bar, "Rings", "3 ratio 0"), "\"0\" is not a ratio"},
      {"cylinder", with(bar, "Rings", "3 ratio two"), "\"two\" is not a ratio"},
      {"cylinder", with(bar, "Rings", "1 ratio 2"), "and only one cell"},
      {"cylinder", with(bar, "Cells along axis", "10 to 30 | 3"), "outside the cylinder"},
      {"cylinder", with(bar, "Cells along axis", "10 | 3"), "does not say where it ends"},
      {"cylinder", with(bar, "Cells along axis", "many"), "\"many\" is not a number of cells"},
      {"cylinder", with(bar, "Cells along axis", "100000"), "all of them coarse"},
      {"cylinder", bar + "set Core radius = 3.5", "must be inside of the first circle"},
      {"cylinder", bar + "set Core corner angle = 180", "Mesh/cylinder/Core corner angle"},
      {"cylinder", bar + "set Axis = w", "Mesh/cylinder/Axis"},
      {"cylinder", bar + "set Foot = 0, 0", "Mesh/cylinder/Foot"},
      {"cylinder", bar + "set Symmetry planes = z", "\"z\" is not an axis across the cylinder"},
      {"cylinder", bar + "set Symmetry planes = x, x", "\"x\" stands twice"},
      {"cylinder", bar + "set Lenght = 3", "Did you mean \"Length\""},
      {"cylinder", "set Radius = 1", "is missing"},
      {"disc", with(disc, "Thickness", "-1"), "Mesh/disc/Thickness"},
      {"disc", with(disc, "Rings", "3 to 3.2 | 5 to 3"), "Ends must increase"},
      {"spherical shell", "set Inner radius = 2\nset Outer radius = 1", "larger than the inner"},
      {"spherical shell", shell + "set Cells along edge = 5", "must be even"},
      {"spherical shell",
       shell + "set Cells along edge = 4\nset Cells through thickness = 2 to 3 | 1",
       "outside the shell"},
      {"spherical shell", shell + "set Cells along edge = 40000\nset Cells through thickness = 1",
       "at most 4000000"},
  };
  for (const auto &a_case : cases)
  {
    const std::string error = error_of<3>(a_case.source, a_case.entries);
    EXPECT_TRUE(contains(error, a_case.message)) << a_case.entries;
    EXPECT_TRUE(contains(error, "scene.prm")) << a_case.entries;
  }
  EXPECT_TRUE(contains(error_of<2>("disc", "set Radius = 1\nset Core cells = 2\nset Rings = 1\n"
                                           "set Symmetry planes = z"),
                       "\"z\" is not an axis across the disc"));
}
