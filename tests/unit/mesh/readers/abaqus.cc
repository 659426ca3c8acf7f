// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2
#include <tombolo/mesh/boundary_names.h>

#include <mesh_file_testing.h>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** Two instances of a bar of two cells and one of a plate, as Abaqus/CAE writes them: the second
   * bar is moved and turned, the plate stands on it. */
  const std::string cae = R"(*Heading
** Job name: Job-1 Model name: Model-1
*Preprint, echo=NO, model=NO, history=NO, contact=NO
** PARTS
*Part, name=Bar
*Node
      1,           0.,           0.,           0.
      2,           1.,           0.,           0.
      3,           1.,           1.,           0.
      4,           0.,           1.,           0.
      5,           0.,           0.,           1.
      6,           1.,           0.,           1.
      7,           1.,           1.,           1.
      8,           0.,           1.,           1.
      9,           2.,           0.,           0.
     10,           2.,           1.,           0.
     11,           2.,           0.,           1.
     12,           2.,           1.,           1.
*Element, type=C3D8R
1,  1,  2,  3,  4,  5,  6,  7,  8
2,  2,  9, 10,  3,  6, 11, 12,  7
*Nset, nset=Set-1, generate
  1,  12,   1
*Elset, elset=Set-1, generate
 1,  2,  1
*Elset, elset=foot
 1,
*Nset, nset=start
 1, 4, 5, 8
** Section: Section-1
*Solid Section, elset=Set-1, material=Steel
,
*End Part
*Part, name=Plate
*Node
 1, 0, 0, 0
 2, 1, 0, 0
 3, 1, 1, 0
 4, 0, 1, 0
 5, 0, 0, 0.5
 6, 1, 0, 0.5
 7, 1, 1, 0.5
 8, 0, 1, 0.5
*Element, type=C3D8
 1, 1, 2, 3, 4, 5, 6, 7, 8
*Elset, elset=Set-1
 1,
*End Part
*Part, name=Unused
*End Part
** ASSEMBLY
*Assembly, name=Assembly
*Instance, name=Bar-1, part=Bar
*End Instance
*Instance, name=Bar-2, part=Bar
         10.,           0.,           0.
         10.,           0.,           0.,          10.,           0.,           1.,         90.
*End Instance
*Instance, name=Plate-1, part=Plate
 0., 0., 5.
*End Instance
*Node
 1, 100., 0., 0.
*Nset, nset=_PickedSet4, internal
 1,
*Elset, elset=_Ends_S4, internal, instance=Bar-1
 2,
*Elset, elset=_Ends_S6, internal, instance=Bar-2,
 generate
 1,  1,  1
*Surface, type=ELEMENT, name=Ends
_Ends_S4, S4
_Ends_S6, S6
*Surface, type=ELEMENT, name=Top
Plate-1.1, S2
*Elset, elset=all plates
 Plate-1.Set-1
*End Assembly
*Material, name=Steel
*Density
 7.85e-09,
*Step, name=Step-1, nlgeom=YES
*Dynamic, Explicit
, 1.
*End Step
)";

  std::string cube(const std::string &type, const std::string &elements)
  {
    return "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n"
           "*ELEMENT, TYPE=" +
           type + ", ELSET=body\n" + elements;
  }
} // namespace

TEST(AbaqusFile, reads_parts_and_instances_as_cae_writes_them)
{
  const TemporaryFile file(cae, ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 5u);
  EXPECT_NEAR(volume_of(*mesh, "Bar"), 4, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "Bar-1"), 2, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "foot"), 2, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "Bar-2.foot"), 1, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "Plate-1.Set-1"), 0.5, 1e-13);
  EXPECT_NEAR(volume_of(*mesh, "all plates"), 0.5, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "Ends"), 2, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "Top"), 1, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "start"), 2, 1e-13);
  EXPECT_NEAR(area_of(*mesh, "Bar-1.start"), 1, 1e-13);
  EXPECT_EQ(mesh->group_names.count("Set-1") + mesh->joint_groups.count("Set-1"), 0u);
  for (const char *part :
       {"sets called \"Set-1\"", "as in \"Bar-1.NAME\"", "The part \"Unused\"",
        "The instance \"Bar-2\" of the mesh file is moved by (10, 0, 0) and then turned by 90 "
        "degrees about the axis from (10, 0, 0) to (10, 0, 1)",
        "*DENSITY (1 time, line 80)", "*SOLID SECTION (1 time"})
    EXPECT_TRUE(has_remark(mesh->remarks, part));
}

TEST(AbaqusFile, instances_are_moved_and_turned)
{
  const TemporaryFile file(cae, ".inp");
  const auto mesh = mesh_of<3>(file.path);
  // The bar from x = 10 to 12 points along y after its turn, and lies at x = 9 to 10.
  const auto id = *mesh->joint_groups.at("Bar-2").begin();
  double lowest_x = 100, highest_y = -100;
  for (const auto &cell : mesh->triangulation.active_cell_iterators())
    if (cell->is_locally_owned() && mesh->joint_groups.at("Bar-2").count(cell->material_id()) > 0)
      for (const unsigned int v : cell->vertex_indices())
      {
        lowest_x = std::min(lowest_x, cell->vertex(v)[0]);
        highest_y = std::max(highest_y, cell->vertex(v)[1]);
      }
  EXPECT_NE(id, 0u);
  EXPECT_EQ(dealii::Utilities::MPI::min(lowest_x, MPI_COMM_WORLD), 9);
  EXPECT_EQ(dealii::Utilities::MPI::max(highest_y, MPI_COMM_WORLD), 2);
}

TEST(AbaqusFile, names_are_usable_by_parts_and_conditions)
{
  const TemporaryFile file(cae, ".inp");
  const MeshScene<3> model("file", "set File = " + file.path,
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

TEST(AbaqusFile, reads_the_sets_that_gmsh_writes)
{
  const TemporaryFile file(cube("C3D8", "2, 1,2,3,4,5,6,7,8\n") +
                               "*ELEMENT, type=CPS4, ELSET=Surface1\n1, 1, 4, 8, 5\n"
                               "*ELEMENT, type=T3D2, ELSET=Line1\n9, 1, 4\n"
                               "*ELSET,ELSET=left\n1, \n*ELSET,ELSET=edge\n9,\n"
                               "*NSET,NSET=ends\n1, 4, 5, 8,\n2, 3, 6, 7\n*NSET,NSET=corner\n1\n",
                           ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_NEAR(area_of(*mesh, "left"), 1, 1e-14);
  // All nodes are in the set, and with them all six faces.
  EXPECT_NEAR(area_of(*mesh, "ends"), 6, 1e-14);
  EXPECT_NEAR(volume_of(*mesh, "body"), 1, 1e-14);
  EXPECT_TRUE(has_remark(mesh->remarks, "no boundary, for \"corner\" (1 of 1 nodes)"));
  EXPECT_TRUE(has_remark(mesh->remarks, "*ELEMENT, TYPE=T3D2 (1 time"));
}

TEST(AbaqusFile, elements_of_second_order_keep_their_corners)
{
  const std::string nodes =
      "*NODE\n11,0.5,-0.1,0\n12,1,0.5,0\n13,0.5,1,0\n14,0,0.5,0\n15,0.5,0,1\n16,1,0.5,1\n"
      "17,0.5,1,1\n18,0,0.5,1\n19,0,0,0.5\n20,1,0,0.5\n21,1,1,0.5\n22,0,1,0.5\n";
  const TemporaryFile file(cube("C3D20R", "1, 1,2,3,4,5,6,7,8, 11,12,13,14,15,16,17,\n"
                                          "18,19,20,21,22\n") +
                               nodes + "*SURFACE, NAME=top\nbody, S2\n",
                           ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_NEAR(volume_of(*mesh, "body"), 1, 1e-14);
  EXPECT_NEAR(area_of(*mesh, "top"), 1, 1e-14);
  EXPECT_TRUE(has_remark(mesh->remarks, "by up to 0.1 of the length of the edge (line 11)"));
}

TEST(AbaqusFile, rigid_surfaces_beside_the_body_are_left_out)
{
  const TemporaryFile file(cube("C3D8", "1, 1,2,3,4,5,6,7,8\n") +
                               "*NODE\n31,0,0,9\n32,1,0,9\n33,1,1,9\n34,0,1,9\n"
                               "*ELEMENT, TYPE=R3D4, ELSET=tool\n7, 31,32,33,34\n"
                               "*ELEMENT, TYPE=R3D3, ELSET=tool\n8, 31,32,33\n"
                               "*ELEMENT, TYPE=MASS, ELSET=mass\n9, 31\n",
                           ".inp");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_TRUE(mesh->boundary_names.empty());
  EXPECT_TRUE(has_remark(mesh->remarks,
                         "\"tool\" of the mesh file has 1 faces that are no faces of "
                         "cells"));
  EXPECT_TRUE(has_remark(mesh->remarks, "*ELEMENT, TYPE=R3D3 (1 time"));
}

TEST(AbaqusFile, a_part_in_another_unit_is_remarked)
{
  const std::string far =
      replaced(cae, " 1, 0, 0, 0\n 2, 1, 0, 0\n 3, 1, 1, 0\n 4, 0, 1, 0",
               " 1, 0, 0, 0\n 2, 1000, 0, 0\n 3, 1000, 1000, 0\n 4, 0, 1000, 0");
  const TemporaryFile file(replaced(far,
                                    " 5, 0, 0, 0.5\n 6, 1, 0, 0.5\n 7, 1, 1, 0.5\n 8, 0, 1, 0.5",
                                    " 5, 0, 0, 500\n 6, 1000, 0, 500\n 7, 1000, 1000, 500\n"
                                    " 8, 0, 1000, 500"),
                           ".inp");
  EXPECT_TRUE(has_remark(mesh_of<3>(file.path)->remarks, "the units of the mesh file are probably "
                                                         "mixed"));
}

TEST(AbaqusFile, refuses_what_it_cannot_read_with_line_and_remedy)
{
  const std::string axis = "         10.,           0.,           0.,          10.,           0.,"
                           "           1.,         90.";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {replaced(cae, "name=Bar-1, part=Bar\n", "name=Bar-1, part=Rod\n"),
       "line 53: The instance \"Bar-1\" is of the part \"Rod\", and there is no such part"},
      {replaced(cae, "name=Bar-2, part=Bar", "name=BAR-1, part=Bar"),
       "line 55: There are two of *INSTANCE called \"BAR-1\""},
      {replaced(cae, axis, "0, 0, 0, 0, 0, 0, 90"), "are one point"},
      {replaced(cae, axis, "1, 2"), "Below *INSTANCE stand a line of three numbers"},
      {replaced(cae, "*End Part\n*Part", "*Part"), "line 33: *PART stands inside of \"Bar\""},
      {replaced(cae, "Plate-1.1, S2", "Plate-1.3, S2"), "There is no element of number 3, which "
                                                        "the surface \"Top\" names"},
      {replaced(cae, "Plate-1.1, S2", "Plate-2.1, S2"), "There is no instance \"Plate-2\". "
                                                        "Instances are \"Bar-1\", \"Bar-2\", "
                                                        "\"Plate-1\""},
      {replaced(cae, "Plate-1.1, S2", "Plate-1.1, S9"), "is called \"S9\". Allowed are S1 to S6"},
      {replaced(cae, " 1, 4, 5, 8\n", " 1, 4, 5, 88\n"),
       "line 29: There is no node of number 88, which the set \"start\" names"},
      {replaced(cae, "*Preprint, echo=NO", "*Include, input=mesh.inp\n*Preprint, echo=NO"),
       "line 3: \"mesh.inp\", relative to the file that names it: There is no such file"},
      {replaced(cae, "*Preprint, echo=NO", "*Ngen, nset=a\n1, 5, 1\n*Preprint, echo=NO"),
       "line 3: *NGEN is not allowed: it makes or moves nodes"},
      {replaced(cae, "*Part, name=Bar\n*Node", "*Part, name=Bar\n*Node, system=C"),
       "line 6: *NODE with SYSTEM=C is not allowed"},
      {replaced(cae, "type=C3D8\n", "type=C3D6\n"), "they are wedges"},
      {replaced(cae, "type=C3D8\n", "type=C3D10M\n"), "they are tetrahedra"},
      {replaced(cae, "type=C3D8\n", "type=CAX4\n"), "Elements of type CAX4 are not allowed"},
      {replaced(cae, "type=C3D8\n", "type=S3\n"), "they are triangles"},
      {replaced(cae, "*Elset, elset=all plates\n Plate-1.Set-1",
                "*Elset, elset=a\nb\n*Elset, elset=b\na"),
       "The set \"a\" contains itself"},
  };
  for (const auto &[bad, message] : cases)
    EXPECT_TRUE(contains(error_of_file<3>(bad, ".inp"), message));
  EXPECT_TRUE(contains(error_of_file<3>(replaced(cae, "type=C3D8\n", "type=C3D4\n"), ".inp"),
                       "Mesh.SubdivisionAlgorithm = 2"));
}
