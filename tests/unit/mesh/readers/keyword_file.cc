// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <mesh_file_testing.h>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const std::string nodes = R"($# LS-DYNA keyword file
*KEYWORD
*TITLE
$# title
two cubes, 1
*NODE
$#   nid               x               y               z      tc      rc
       1             0.0             0.0             0.0       0       0
       2             1.0             0.0             0.0
       3             1.0             1.0             0.0
       4             0.0             1.0             0.0
       5             0.0             0.0             1.0
       6             1.0             0.0             1.0
       7             1.0             1.0             1.0
       8             0.0             1.0             1.0
       9             2.0             0.0             0.0
      10             2.0             1.0             0.0
      11             2.0             0.0             1.0
      12             2.0             1.0             1.0
)";

  const std::string parts = R"(*PART
$# title
bullet
$#     pid     secid       mid     eosid      hgid
        11         1         1
wall
        22         1         2
)";

  const std::string one_card = R"(*ELEMENT_SOLID
$#   eid     pid      n1      n2      n3      n4      n5      n6      n7      n8
       1      11       1       2       3       4       5       6       7       8
       2      22       2       9      10       3       6      11      12       7
)";

  const std::string two_cards = R"(*ELEMENT_SOLID (ten nodes format)
       1      11
       1       2       3       4       5       6       7       8       0       0
       2      22
       2       9      10       3       6      11      12       7
)";

  const std::string commas = "*ELEMENT_SOLID\n1,11,1,2,3,4,5,6,7,8\n2,22\n2,9,10,3,6,11,12,7\n";

  const std::string sets = R"(*SET_NODE_LIST_TITLE
struck end
         1       0.0       0.0       0.0       0.0
         1         4         5         8
*SET_SEGMENT
         7
         9        10        12        11       0.0       0.0       0.0       0.0
*SET_SOLID_TITLE
half
         3
         1
*SET_PART_LIST
         4
        11        22
*CONTROL_TERMINATION
       1.0
*MAT_ELASTIC
         1     7.85       1.0
*END
what follows is not read
)";

  void expect_two_cubes(const Mesh<3> &mesh)
  {
    EXPECT_EQ(mesh.triangulation.n_global_active_cells(), 2u);
    const Measures<3> measures(mesh);
    EXPECT_EQ(mesh.group_names.at("bullet"), 11u);
    EXPECT_EQ(mesh.group_names.at("part 22"), 22u);
    EXPECT_EQ(mesh.group_names.at("wall"), 22u);
    EXPECT_NEAR(measures.volume.at(11), 1, 1e-14);
    EXPECT_NEAR(measures.volume.at(22), 1, 1e-14);
  }
} // namespace

TEST(KeywordFile, reads_elements_on_one_card_and_on_two)
{
  for (const auto &elements : {one_card, two_cards, commas})
  {
    const TemporaryFile file(nodes + elements + parts + sets, ".k");
    const auto mesh = mesh_of<3>(file.path);
    expect_two_cubes(*mesh);
    const Measures<3> measures(*mesh);
    EXPECT_EQ(mesh->group_names.at("half"), 11u);
    EXPECT_EQ(mesh->joint_groups.at("part set 4"), (std::set<dealii::types::material_id>{11, 22}));
    EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("struck end")), 1, 1e-14);
    EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("segment set 7")), 1, 1e-14);
    EXPECT_NE(mesh->boundary_names.at("struck end"), mesh->boundary_names.at("segment set 7"));
    EXPECT_TRUE(has_remark(mesh->remarks, "*CONTROL_TERMINATION (1 time"));
    EXPECT_TRUE(has_remark(mesh->remarks, "*MAT_ELASTIC (1 time"));
    EXPECT_TRUE(has_remark(mesh->remarks, "scripts/import_keyword"));
  }
}

TEST(KeywordFile, reads_wide_fields)
{
  std::string wide = "*KEYWORD LONG=Y\n*NODE\n";
  const double x[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                          {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const auto field = [](const std::string &text)
  { return std::string(20 - text.size(), ' ') + text; };
  for (unsigned int n = 0; n < 8; ++n)
  {
    wide += field(std::to_string(n + 1));
    for (const double coordinate : x[n])
      wide += field(std::to_string(coordinate));
    wide += "\n";
  }
  wide += "*ELEMENT_SOLID\n" + field("1") + field("5") + "\n";
  for (unsigned int n = 0; n < 8; ++n)
    wide += field(std::to_string(n + 1));
  const TemporaryFile file(wide + "\n*END\n", ".key");
  EXPECT_NEAR(Measures<3>(*mesh_of<3>(file.path)).volume.at(5), 1, 1e-14);
}

TEST(KeywordFile, a_set_that_cuts_a_part_is_a_group_beside_it)
{
  const std::string one_part = replaced(one_card, "2      22", "2      11");
  const TemporaryFile file(nodes + one_part + sets, ".k");
  const auto mesh = mesh_of<3>(file.path);
  const Measures<3> measures(*mesh);
  EXPECT_EQ(mesh->joint_groups.at("part 11").size(), 2u);
  EXPECT_NEAR(measures.volume.at(mesh->group_names.at("half")), 1, 1e-14);
}

TEST(KeywordFile, names_are_told_apart)
{
  std::string text = nodes + one_card + replaced(parts, "\nwall\n", "\nbullet\n") + sets + "";
  text = replaced(text, "*SET_SEGMENT\n", "*SET_SEGMENT_TITLE\nrear, #end\n");
  const TemporaryFile file(text, ".k");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_EQ(mesh->group_names.at("bullet"), 11u);
  EXPECT_EQ(mesh->group_names.at("bullet (part 22)"), 22u);
  EXPECT_EQ(mesh->boundary_names.count("rear end"), 1u);
  EXPECT_TRUE(has_remark(mesh->remarks, "cannot stand in a parameter file: it is called \"rear "
                                        "end\""));
}

TEST(KeywordFile, reads_a_plane_of_shells)
{
  const TemporaryFile file(nodes +
                               "*ELEMENT_SHELL\n       1       3       1       2       3       4\n"
                               "       2       3       2       9      10       3\n"
                               "*SET_SEGMENT\n         5\n         1         4\n",
                           ".k");
  const auto mesh = mesh_of<2>(file.path);
  const Measures<2> measures(*mesh);
  EXPECT_NEAR(measures.volume.at(3), 2, 1e-14);
  EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("segment set 5")), 1, 1e-14);
}

TEST(KeywordFile, shells_on_solids_are_boundaries_and_others_are_left_out)
{
  const TemporaryFile file(nodes + "      21             0.0             0.0             9.0\n" +
                               one_card + replaced(parts, "*PART\n", "*PART\ncoat\n        33\n") +
                               "*ELEMENT_SHELL\n7,33,1,4,8,5\n8,33,1,4,8,8\n9,44,21,1,4,5\n",
                           ".k");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_NEAR(Measures<3>(*mesh).area.at(mesh->boundary_names.at("coat")), 1, 1e-14);
  EXPECT_EQ(mesh->boundary_names.size(), 1u);
  EXPECT_TRUE(
      has_remark(mesh->remarks, "\"part 44\" of the mesh file has 1 faces that are no faces"));
  EXPECT_TRUE(has_remark(mesh->remarks, "*ELEMENT_SHELL of three nodes (1 time"));
}

TEST(KeywordFile, refuses_what_it_cannot_read_with_line_and_remedy)
{
  const std::string all = nodes + one_card + parts + sets;
  const std::string second =
      "       2      22       2       9      10       3       6      11      "
      "12       7";
  const auto with_second = [&](const std::string &element)
  { return replaced(all, second, element); };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with_second("2,22,2,9,10,3,3,3,3,3"), "line 23: An element is a tetrahedron"},
      {with_second("2,22\n2,9,10,3"), "line 23: An element is a tetrahedron of 4 nodes"},
      {with_second("2,22\n2,9,10,3,6,11,12,7,1,4"), "An element is a tetrahedron of 10 nodes"},
      {with_second("2,22,2,9,10,3,6,6,11,11"), "line 23: An element is a wedge"},
      {with_second("2,22,2,9,10,3,6,6,6,6"), "line 23: An element is a pyramid"},
      {with_second("2,22,2,9,10,3,6,11,12"), "has 8 nodes, and this one has 7"},
      {with_second("2,22,2,9,10,3,6,11,12,77"), "line 23: There is no node of number 77"},
      {with_second("1,22,2,9,10,3,6,11,12,7"), "There are two elements of number 1"},
      {with_second("2,0,2,9,10,3,6,11,12,7"), "The number 0 of a part"},
      {with_second("2,22,x,9,10,3,6,11,12,7"), "\"x\" stands where a number of an element"},
      {replaced(all, "*ELEMENT_SOLID\n", "*ELEMENT_SOLID_TET4TOTET10\n"), "no hexahedra"},
      {replaced(all, "*ELEMENT_SOLID\n", "*ELEMENT_SOLID_ORTHO\n"),
       "*ELEMENT_SOLID_ORTHO is not allowed"},
      {replaced(all, "         1         4         5         8\n", "         1        44\n"),
       "There is no node of number 44"},
      {replaced(all, "*SET_SOLID_TITLE\nhalf\n         3\n         1\n",
                "*SET_SOLID_TITLE\nhalf\n         3\n         9\n"),
       "There is no element of number 9, which the set \"half\" names"},
      {replaced(all, "         9        10        12        11",
                "         9        10        12        12"),
       "A segment is a triangle"},
      {replaced(all, "       2             1.0", "       1             1.0"),
       "line 9: There are two nodes of number 1"},
      {replaced(all, "       2             1.0", "       2             1.x"),
       "line 9: \"1.x\" stands where a coordinate of a node should"},
      {replaced(all, "*PART\n", "*INCLUDE_TRANSFORM\nmesh.k\n*PART\n"),
       "line 24: *INCLUDE_TRANSFORM is not allowed: the mesh could be in the file"},
      {replaced(all, "*PART\n", "*NODE_TRANSFORM\n1,1\n*PART\n"), "it makes or moves nodes"},
      {"1, 2\n", "stands before the first keyword"},
      {"*KEYWORD\n*END\n", "There is no section *NODE"},
  };
  for (const auto &[bad, message] : cases)
    EXPECT_TRUE(contains(error_of_file<3>(bad, ".k"), message));
  EXPECT_TRUE(contains(error_of_file<2>(all, ".k"), "There are solid elements, and the scene has "
                                                    "two dimensions"));
}
