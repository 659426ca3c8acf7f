// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <tombolo/mesh/boundary_names.h>

#include <mesh_file_testing.h>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** A unit cube, or one that is bent in an edge, with @p n_nodes nodes, as gmsh writes it. */
  std::string cube_of_second_order(const unsigned int n_nodes, const double bend)
  {
    const std::vector<std::array<double, 3>> corners = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}},
                                                        {{0, 1, 0}}, {{0, 0, 1}}, {{1, 0, 1}},
                                                        {{1, 1, 1}}, {{0, 1, 1}}};
    const std::vector<std::array<unsigned int, 2>> edges = {{{0, 1}}, {{0, 3}}, {{0, 4}}, {{1, 2}},
                                                            {{1, 5}}, {{2, 3}}, {{2, 6}}, {{3, 7}},
                                                            {{4, 5}}, {{4, 7}}, {{5, 6}}, {{6, 7}}};
    std::vector<std::array<double, 3>> nodes = corners;
    for (const auto &edge : edges)
    {
      std::array<double, 3> node;
      for (unsigned int d = 0; d < 3; ++d)
        node[d] = (corners[edge[0]][d] + corners[edge[1]][d]) / 2;
      nodes.push_back(node);
    }
    nodes[11][1] -= bend;
    nodes.resize(n_nodes, {{0.5, 0.5, 0.5}});

    std::ostringstream text;
    text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << n_nodes << "\n";
    for (unsigned int n = 0; n < n_nodes; ++n)
      text << n + 1 << ' ' << nodes[n][0] << ' ' << nodes[n][1] << ' ' << nodes[n][2] << "\n";
    text << "$EndNodes\n$Elements\n2\n1 16 2 5 5 1 4 8 5 10 16 18 11\n2 "
         << (n_nodes == 20 ? 17 : 12) << " 2 3 3";
    for (unsigned int n = 0; n < n_nodes; ++n)
      text << ' ' << n + 1;
    text << "\n$EndElements\n";
    return text.str();
  }
} // namespace

TEST(GmshFile, binary_files_have_the_same_mesh_and_names_as_text)
{
  const auto text = mesh_of<3>(meshes + "two_blocks_41.msh");
  const auto nodes = nodes_by_id(Nodes<3>(*text, 1));
  for (const std::string file : {"two_blocks_41_binary.msh", "two_blocks_22_binary.msh"})
  {
    SCOPED_TRACE(file);
    const auto mesh = mesh_of<3>(meshes + file);
    EXPECT_EQ(mesh->group_names, text->group_names);
    EXPECT_EQ(mesh->boundary_names, text->boundary_names);
    EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 1)), nodes);
    const Measures<3> measures(*mesh), text_measures(*text);
    EXPECT_EQ(measures.volume, text_measures.volume);
    EXPECT_EQ(measures.area, text_measures.area);
    EXPECT_TRUE(has_remark(mesh->remarks, "\"interface\""));
  }
}

TEST(GmshFile, damaged_binary_files_are_refused_with_the_byte)
{
  const std::string text = read_text_file(meshes + "two_blocks_41_binary.msh");
  const std::string other_order = text.substr(0, text.find('\n', 12) + 1) +
                                  std::string("\0\0\0\1", 4) +
                                  text.substr(text.find("\n$EndMeshFormat"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {text.substr(0, text.find("$EndNodes") - 20), "The file ends where a coordinate of a node"},
      {text.substr(0, text.find("$EndElements") - 20), "The file ends where the number of a node"},
      {other_order, "with another order of bytes"},
      {replaced(text, "$EndNodes", "$EndNode_"), "stands where $EndNodes should"},
  };
  for (const auto &[bad, message] : cases)
  {
    const std::string error = error_of_file<3>(bad, ".msh");
    EXPECT_TRUE(contains(error, message));
    EXPECT_TRUE(contains(error, ".msh\", byte "));
  }
}

TEST(GmshFile, hexahedra_of_second_order_keep_their_corners_and_say_what_is_lost)
{
  for (const unsigned int n_nodes : {20u, 27u})
  {
    const TemporaryFile bent(cube_of_second_order(n_nodes, 0.125), ".msh");
    const auto mesh = mesh_of<3>(bent.path);
    EXPECT_NEAR(Measures<3>(*mesh).volume.at(3), 1, 1e-14);
    EXPECT_NEAR(Measures<3>(*mesh).area.at(5), 1, 1e-14);
    EXPECT_TRUE(has_remark(mesh->remarks, "1 cells of the mesh file are of second order"));
    EXPECT_TRUE(has_remark(mesh->remarks, "by up to 0.125 of the length of the edge (line"));
    const TemporaryFile straight(cube_of_second_order(n_nodes, 0), ".msh");
    EXPECT_TRUE(has_remark(mesh_of<3>(straight.path)->remarks, "so that the shape is the same"));
  }
}

TEST(GmshFile, other_shapes_are_refused_with_the_way_to_hexahedra)
{
  const std::string text = read_text_file(meshes + "two_blocks_22.msh");
  const std::string begin = text.substr(0, text.find("$Elements")) + "$Elements\n1\n1 ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"4 2 6 1 1 3 4 2", "tetrahedra"},
      {"6 2 6 1 1 3 4 2 5 6", "prisms"},
      {"7 2 6 1 1 3 4 2 5", "pyramids"}};
  for (const auto &[element, name] : cases)
  {
    const std::string error = error_of_file<3>(begin + element + "\n$EndElements\n", ".msh");
    EXPECT_TRUE(contains(error, "There are " + name + ". Allowed are hexahedra only."));
    EXPECT_TRUE(contains(error, "Mesh.SubdivisionAlgorithm = 2"));
    EXPECT_TRUE(contains(error, "RefineMesh; Save 'NEW.msh'"));
  }
  const std::string plane = read_text_file(meshes + "two_squares.msh");
  EXPECT_TRUE(
      contains(error_of_file<2>(replaced(plane, "5 3 2 1 1 1 2 5 4", "5 2 2 1 1 1 2 5"), ".msh"),
               "There are triangles. Allowed are quadrilaterals only. In gmsh, set "
               "Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1"));
}

TEST(GmshFile, boundaries_and_groups_may_overlap)
{
  std::string text = read_text_file(meshes + "two_squares.msh");
  text = replaced(text, "4 1 2 8 3 1 2", "4 1 2 8 3 3 6");
  text = replaced(text, "$Elements\n6", "$Elements\n7");
  text = replaced(text, "$EndElements", "7 1 2 8 3 1 2\n$EndElements");
  const TemporaryFile file(text, ".msh");
  const auto mesh = mesh_of<2>(file.path);
  // The edge at the right is in both boundaries, the lower one in "8" alone.
  EXPECT_EQ(mesh->boundary_names.size(), 1u);
  EXPECT_EQ(mesh->joint_boundaries.at("8").size(), 2u);
  const Measures<2> measures(*mesh);
  double length = 0;
  for (const auto id : mesh->joint_boundaries.at("8"))
    length += measures.area.at(id);
  EXPECT_NEAR(length, 2, 1e-14);
  EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("free edge")), 1, 1e-14);
}

TEST(GmshFile, sets_of_nodes_are_boundaries_by_their_faces)
{
  const auto mesh = mesh_of<3>(meshes + "bars_and_plate.msh");
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 5u);
  EXPECT_NEAR(volume_of(*mesh, "Bar"), 4, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "Bar-2.foot"), 1, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "Ends"), 2, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "start"), 2, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "Bar-1.start"), 1, 1e-13);
  // A point alone is no boundary.
  const std::string text = read_text_file(meshes + "two_squares.msh");
  const TemporaryFile file(replaced(text, "$PhysicalNames\n3", "$PhysicalNames\n4\n0 9 \"tip\""),
                           ".msh");
  EXPECT_TRUE(
      has_remark(mesh_of<2>(file.path)->remarks, "no boundary, for \"tip\" (1 of 1 nodes)"));
}

TEST(GmshFile, names_are_usable_by_parts_and_conditions)
{
  const MeshScene<3> model("file", "set File = " + meshes + "bars_and_plate.msh",
                           {{"feet", "group foot"}, {"rest", "otherwise"}});
  const auto mesh = model.create_mesh();
  const PartCells<3> part_cells(model.part_sections, *mesh);
  part_cells.check(mesh->triangulation);
  unsigned int n_feet = 0;
  for (const auto &cell : mesh->triangulation.active_cell_iterators())
    if (cell->is_locally_owned())
      n_feet += part_cells.part_of(cell) == 0;
  EXPECT_EQ(dealii::Utilities::MPI::sum(n_feet, MPI_COMM_WORLD), 2u);

  Parameters parameters(MPI_COMM_WORLD);
  parameters.read_text("subsection Condition: c\nset Boundary = start, Ends\nend\n", "scene.prm");
  parameters.handler().enter_subsection("Condition: c");
  parameters.handler().declare_entry("Boundary", "");
  parameters.handler().leave_subsection();
  parameters.assign();
  const auto ids = boundary_ids(*mesh, parameters.section("Condition: c"), "Boundary");
  const Measures<3> measures(*mesh);
  double area = 0;
  for (const auto id : ids)
    area += measures.area.at(id);
  // The end S6 of the second bar is its start.
  EXPECT_NEAR(area, 3, 1e-13);
}

TEST(GmshFile, a_part_in_another_unit_is_remarked)
{
  const std::string text = read_text_file(meshes + "two_squares.msh");
  const TemporaryFile file(
      replaced(replaced(text, "3 2 0 0", "3 2000 0 0"), "6 2 1 0", "6 2000 1 0"), ".msh");
  EXPECT_TRUE(
      has_remark(mesh_of<2>(file.path)->remarks, "the units of the mesh file are probably mixed"));
}
