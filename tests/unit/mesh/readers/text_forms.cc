// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <mesh_file_testing.h>

#include <regex>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  using Change = std::pair<std::string, std::string>;

  std::string changed(std::string text, const std::vector<Change> &changes)
  {
    for (const auto &[old_part, new_part] : changes)
      text = replaced(std::move(text), old_part, new_part);
    return text;
  }

  std::string with_line_ends_of_windows(const std::string &text)
  {
    return std::regex_replace(text, std::regex("\n"), "\r\n");
  }

  const std::string byte_order_mark = "\xef\xbb\xbf";

  /** Volumes, areas and names of a mesh, which other forms of its file have as well. */
  void expect_same_mesh(const Mesh<3> &mesh, const Mesh<3> &expected)
  {
    const Measures<3> measures(mesh), expected_measures(expected);
    EXPECT_EQ(measures.volume.size(), expected_measures.volume.size());
    for (const auto &[id, volume] : expected_measures.volume)
      EXPECT_NEAR(measures.volume.at(id), volume, 1e-13);
    for (const auto &[id, area] : expected_measures.area)
      EXPECT_NEAR(measures.area.at(id), area, 1e-13);
    EXPECT_EQ(mesh.group_names, expected.group_names);
    EXPECT_EQ(mesh.boundary_names, expected.boundary_names);
    EXPECT_EQ(mesh.joint_groups, expected.joint_groups);
    EXPECT_EQ(mesh.joint_boundaries, expected.joint_boundaries);
  }
} // namespace

TEST(TextForms, marks_line_ends_and_case_are_no_difference)
{
  for (const std::string file : {"two_blocks_22.msh", "two_blocks_41.msh", "two_cubes.vtk"})
  {
    SCOPED_TRACE(file);
    const std::string extension = std::filesystem::path(file).extension().string();
    const std::string text = read_text_file(meshes + file);
    const auto expected = mesh_of<3>(meshes + file);
    for (const auto &form : {byte_order_mark + text, with_line_ends_of_windows(text),
                             byte_order_mark + with_line_ends_of_windows(text)})
    {
      const TemporaryFile other(form, extension);
      expect_same_mesh(*mesh_of<3>(other.path), *expected);
    }
  }
}

TEST(TextForms, words_of_vtk_do_not_differ_by_case)
{
  const std::string text = read_text_file(meshes + "two_cubes.vtk");
  const TemporaryFile file(
      changed(text, {{"ASCII", "ascii"}, {"POINTS", "points"}, {"SCALARS", "Scalars"}}), ".vtk");
  expect_same_mesh(*mesh_of<3>(file.path), *mesh_of<3>(meshes + "two_cubes.vtk"));
}

TEST(TextForms, names_that_are_not_utf_8_are_latin_1)
{
  const std::string text = read_text_file(meshes + "two_blocks_22.msh");
  const TemporaryFile file(replaced(text, "struck end", "H\xfclse"), ".msh");
  EXPECT_EQ(mesh_of<3>(file.path)->boundary_names.count("Hülse"), 1u);
  EXPECT_TRUE(contains(error_of_file<3>("\xff\xfe$\0N\0", ".msh"), "UTF-16"));
}

TEST(TextForms, numbers_of_fortran_are_read)
{
  const std::string text = read_text_file(meshes + "two_cubes.vtk");
  const TemporaryFile file(replaced(text, "2 0 0  2 1 0", "2.0D+00 0 0  0.2+01 1 0"), ".vtk");
  expect_same_mesh(*mesh_of<3>(file.path), *mesh_of<3>(meshes + "two_cubes.vtk"));
}

TEST(TextForms, cells_that_gmsh_repeats_are_in_all_their_groups)
{
  const std::string head = "$PhysicalNames\n3\n3 1 \"foot\"\n3 2 \"head\"\n3 3 \"specimen\"\n"
                           "$EndPhysicalNames\n";
  const std::string nodes =
      "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"
      "9 0 0 2\n10 1 0 2\n11 1 1 2\n12 0 1 2\n";
  const std::string old_form =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + head + "$Nodes\n12\n" + nodes +
      "$EndNodes\n$Elements\n4\n1 5 2 3 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 1 2 3 4 5 6 7 8\n"
      "3 5 2 2 2 5 6 7 8 9 10 11 12\n4 5 2 3 2 5 6 7 8 9 10 11 12\n$EndElements\n";
  const TemporaryFile file(old_form, ".msh");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 2u);
  EXPECT_NEAR(volume_of(*mesh, "foot"), 1, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "head"), 1, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "specimen"), 2, 1e-13);
  EXPECT_TRUE(contains(error_of_file<3>(replaced(old_form, "2 5 2 1 1", "2 5 2 3 1"), ".msh"),
                       "line 28: The cell stands on line 27 already"));
}
