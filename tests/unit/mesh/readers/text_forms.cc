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
  const std::string bar_k = read_text_file(meshes + "bar.k");
  const std::string cubes_inp = read_text_file(meshes + "two_cubes.inp");

  std::string part_of(const std::string &text, const std::string &begin, const std::string &end)
  {
    const auto first = text.find(begin);
    return text.substr(first, text.find(end, first) - first);
  }

  const std::string nodes_k = part_of(bar_k, "*NODE\n", "*ELEMENT");
  const std::string elements_k = part_of(bar_k, "*ELEMENT_SOLID\n", "*SET_NODE");

  std::string joined_by(const std::string &text, const char *separator)
  {
    const std::string without_first = std::regex_replace(text, std::regex("\n +"), "\n");
    return std::regex_replace(without_first, std::regex(" +"), separator);
  }

  /** Volumes, areas and names of a mesh, which other forms of its file have as well. */
  void expect_same_mesh(const Mesh<3> &mesh, const Mesh<3> &expected)
  {
    const Measures<3> measures(mesh), of_expected(expected);
    EXPECT_EQ(measures.volume.size(), of_expected.volume.size());
    for (const auto &[id, volume] : of_expected.volume)
      EXPECT_NEAR(measures.volume.at(id), volume, 1e-13);
    for (const auto &[id, area] : of_expected.area)
      EXPECT_NEAR(measures.area.at(id), area, 1e-13);
    EXPECT_EQ(mesh.group_names, expected.group_names);
    EXPECT_EQ(mesh.boundary_names, expected.boundary_names);
    EXPECT_EQ(mesh.joint_groups, expected.joint_groups);
    EXPECT_EQ(mesh.joint_boundaries, expected.joint_boundaries);
  }
} // namespace

TEST(TextForms, marks_line_ends_and_case_are_no_difference)
{
  for (const std::string file :
       {"two_blocks_22.msh", "two_blocks_41.msh", "two_cubes.inp", "two_cubes.vtk", "bar.k"})
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

TEST(TextForms, decks_of_ls_dyna_are_read_in_all_forms)
{
  const auto expected = mesh_of<3>(meshes + "bar.k");
  const std::string first_element =
      "       1       1       1       5       6       2       4       8       7       3";
  const std::vector<std::pair<std::string, std::vector<Change>>> forms = {
      {"elements first", {{nodes_k + elements_k, elements_k + nodes_k}}},
      {"lower case",
       {{"*NODE\n", "*node\n"}, {"*ELEMENT_SOLID", "*element_solid"}, {"*END", "*end\nx"}}},
      {"remarks", {{first_element, first_element + " cell of the bar, upper half"}}},
      {"commas", {{elements_k, joined_by(elements_k, ",")}}},
      {"tabs", {{elements_k, joined_by(elements_k, "\t")}}},
      {"D",
       {{"        4.000000        0.000000        0.000000",
         "    4.000000D+00      0.0000d+00             0.0"}}},
      {"no letter",
       {{"        4.000000        0.000000        0.000000",
         "          0.4+01          0.0-01             0.0"}}},
      {"columns of a set",
       {{"*SET_NODE_LIST\n         1\n         1         2         3         4",
         "*SET_NODE_COLUMN\n         1\n         1       0.5\n         2\n"
         "         3\n         4"}}},
      {"a set of sets",
       {{"*SET_NODE_LIST\n         1\n         1         2         3         4",
         "*SET_NODE_ADD\n         1\n        11         9\n*SET_NODE_ADD\n"
         "         9\n        12         1\n*SET_NODE_LIST\n        11\n"
         "         1         2\n*SET_NODE_LIST_GENERATE\n        12\n"
         "         3         4"}}},
  };
  for (const auto &[name, changes] : forms)
  {
    SCOPED_TRACE(name);
    const TemporaryFile file(changed(bar_k, changes), ".k");
    const auto mesh = mesh_of<3>(file.path);
    const Measures<3> measures(*mesh);
    EXPECT_NEAR(measures.volume.at(mesh->group_names.at("bar")), 4, 1e-13);
    for (const std::string end : {"node set 1", "node set 2"})
      EXPECT_NEAR(measures.area.at(mesh->boundary_names.at(end)), 1, 1e-13);
    EXPECT_EQ(mesh->group_names, expected->group_names);
  }
}

TEST(TextForms, constraints_of_nodes_are_boundaries)
{
  std::string text = bar_k;
  for (unsigned int node = 1; node <= 4; ++node)
  {
    const std::string number = "\n" + std::string(7, ' ') + std::to_string(node) + " ";
    const auto begin = text.find(number, text.find("*NODE")) + 1;
    text.insert(text.find('\n', begin), "       4       7");
  }
  const TemporaryFile file(text, ".k");
  const auto mesh = mesh_of<3>(file.path);
  for (const std::string axis : {"x", "y"})
  {
    double area = 0;
    const std::string name = "held along " + axis;
    for (const auto id :
         mesh->joint_boundaries.count(name) > 0
             ? mesh->joint_boundaries.at(name)
             : std::set<dealii::types::boundary_id>{
                   static_cast<dealii::types::boundary_id>(mesh->boundary_names.at(name))})
      area += Measures<3>(*mesh).area.at(id);
    EXPECT_NEAR(area, 1, 1e-13);
  }
  EXPECT_EQ(mesh->boundary_names.count("held along z"), 0u);
  EXPECT_TRUE(has_remark(mesh->remarks, "TC of *NODE (first on line 14) holds nodes. They are the "
                                        "boundaries \"held along x\" (4 nodes)"));
}

TEST(TextForms, names_that_are_not_utf_8_are_latin_1)
{
  const std::vector<std::pair<std::string, std::string>> files = {
      {replaced(cubes_inp, "NSET=NS1", "NSET=H\xfclse"), ".inp"},
      {replaced(bar_k, "*SET_NODE_LIST\n         2", "*SET_NODE_LIST_TITLE\nH\xfclse\n         2"),
       ".k"},
      {replaced(read_text_file(meshes + "two_blocks_22.msh"), "struck end", "H\xfclse"), ".msh"}};
  for (const auto &[text, extension] : files)
  {
    const TemporaryFile file(text, extension);
    const auto mesh = mesh_of<3>(file.path);
    // Three nodes are no face.
    if (extension == ".inp")
      EXPECT_TRUE(has_remark(mesh->remarks, "\"Hülse\" (3 of 3 nodes)"));
    else
      EXPECT_EQ(mesh->boundary_names.count("Hülse"), 1u);
  }
  EXPECT_TRUE(contains(error_of_file<3>("\xff\xfe*\0N\0", ".inp"), "UTF-16"));
}

TEST(TextForms, files_are_read_where_they_are_named)
{
  const auto expected = mesh_of<3>(meshes + "two_cubes.inp");
  const std::string second_cube = " 2, 2, 9, 10, 3, 6, 11,\n 12, 7\n";
  const std::string first_nodes = " 1, 0.0, 0.0, 0.0\n 2, 1.0, 0.0, 0.0\n";
  struct Case
  {
    std::string main, included;
  };
  const std::string stem =
      std::filesystem::path(TemporaryFile("", ".dat").path).filename().string();
  for (const auto &[main, included] : std::vector<Case>{
           {replaced(cubes_inp, "ELSET=EB2\n" + second_cube, "ELSET=EB2, INPUT=" + stem + "\n"),
            byte_order_mark + with_line_ends_of_windows(second_cube)},
           {replaced(cubes_inp, "NSET=ALLNODES\n" + first_nodes,
                     "input = .\\" + stem + " , NSET=ALLNODES\n"),
            "** a comment\n" + first_nodes},
           {replaced(cubes_inp, first_nodes, "*INCLUDE, INPUT=" + stem + "\n"), first_nodes},
           {"*INCLUDE, INPUT=" + stem + "\n", cubes_inp}})
  {
    const TemporaryFile part(included, ".dat"), file(main, ".inp");
    expect_same_mesh(*mesh_of<3>(file.path), *expected);
  }
  const auto bar = mesh_of<3>(meshes + "bar.k");
  {
    const TemporaryFile part("*KEYWORD\n" + elements_k + nodes_k + "*END\nnot read\n", ".dat"),
        file(replaced(bar_k, nodes_k + elements_k, "*INCLUDE\n" + stem + "\n"), ".k");
    const auto mesh = mesh_of<3>(file.path);
    EXPECT_EQ(mesh->group_names, bar->group_names);
    EXPECT_EQ(mesh->boundary_names, bar->boundary_names);
  }
}

TEST(TextForms, lines_of_included_files_are_named)
{
  const std::string stem =
      std::filesystem::path(TemporaryFile("", ".dat").path).filename().string();
  const std::string of_file = " of \"" + stem + "\"";
  const auto error = [&](const std::string &main, const std::string &included)
  {
    const TemporaryFile part(included, ".dat"), file(main, ".inp");
    return input_error([&]() { mesh_of<3>(file.path); });
  };
  const std::string main =
      replaced(cubes_inp, "*HEADING\n", "*INCLUDE, INPUT=" + stem + "\n*HEADING\n");
  EXPECT_TRUE(contains(error(main, "*NODE\n51, 0, 0, 0\n52, x, 0, 0\n"),
                       "line 3" + of_file + ": \"x\" stands where"));
  EXPECT_TRUE(contains(error(main, "*NSET, NSET=a\n77\n"),
                       "line 2" + of_file + ": There is no node of number 77"));
  EXPECT_TRUE(contains(error(main, "*INCLUDE, INPUT=" + stem + "\n"),
                       "line 1" + of_file + ": \"" + stem + "\" includes itself"));
  EXPECT_TRUE(contains(error(main, "*NODE\n51, 0, 0, 0\n*ELEMENT, TYPE=C3D8, ELSET=a\n"
                                   "51, 1, 2, 3, 4, 5, 6, 7, 51\n"),
                       "line 4" + of_file + ": A cell is"));
  EXPECT_TRUE(contains(error(replaced(main, " 4, 0.0", " 3, 0.0"), "** nothing\n"),
                       "line 10: There are two nodes of number 3"));
  const TemporaryFile part("*AMPLITUDE, NAME=a\n0, 0\n", ".dat"), file(main, ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_TRUE(has_remark(mesh->remarks, "*AMPLITUDE (1 time, line 1" + of_file + ")"));
}

TEST(TextForms, what_exists_of_a_range_is_taken_and_the_rest_is_counted)
{
  const TemporaryFile file(cubes_inp + "*NSET, NSET=near, GENERATE\n 1, 8\n"
                                       "*NSET, NSET=whole, GENERATE\n 1, 3000000000, 1\n"
                                       "*ELSET, ELSET=both, GENERATE\n 1, 9, 1\n"
                                       "*SURFACE, NAME=top, TRIM=YES\n 1, S2\n",
                           ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_NEAR(volume_of(*mesh, "both"), 2, 1e-13);
  EXPECT_TRUE(has_remark(mesh->remarks,
                         "Missing are 2999999988 of 3000000000 nodes of the set \"whole\" (line"));
  EXPECT_TRUE(has_remark(mesh->remarks, "6 of 9 elements of the set \"both\" (line"));
  EXPECT_FALSE(has_remark(mesh->remarks, "\"near\" (line"));
  EXPECT_TRUE(has_remark(mesh->remarks, "*SURFACE with TRIM (1 time, line"));
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

TEST(TextForms, what_is_not_read_is_refused_with_its_line)
{
  const std::vector<std::pair<std::string, std::string>> cases = {
      {replaced(bar_k, "        4.000000", "          &right"),
       "\"&right\" stands where a coordinate of a node should. Parameters (*PARAMETER)"},
      {replaced(bar_k, "       1       1       1       5", "1\t1\t1\t12345678901"),
       "line 35: The card has tabs"},
      {replaced(bar_k, "*SET_NODE_LIST\n         1\n         1",
                "*SET_NODE_ADD\n         1\n         5"),
       "line 41: There is no set of nodes of number"},
      {replaced(bar_k, "20        4.0", "20        4.0x"), "line 33: \"4.0x"},
      {replaced(bar_k, elements_k, replaced(elements_k, "7       3", "7      33")),
       "line 35: There is no node of number 33"},
  };
  for (const auto &[bad, message] : cases)
    EXPECT_TRUE(contains(error_of_file<3>(bad, ".k"), message));
}
