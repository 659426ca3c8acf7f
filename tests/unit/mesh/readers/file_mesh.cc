// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <deal.II/base/mpi.h>

#include <tombolo/mesh/nodes.h>

#include <mesh_file_testing.h>

using namespace tombolo;
using namespace tombolo::testing;

TEST(FileMesh, reads_both_text_formats_of_gmsh_with_names_and_an_inner_surface)
{
  for (const std::string file : {"two_blocks_22.msh", "two_blocks_41.msh"})
  {
    SCOPED_TRACE(file);
    const auto mesh = mesh_of<3>(meshes + file);
    EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 16u);
    EXPECT_EQ(mesh->group_names, (std::map<std::string, dealii::types::material_id>{
                                     {"left half", 10}, {"right half", 20}}));
    EXPECT_EQ(mesh->boundary_names,
              (std::map<std::string, dealii::types::boundary_id>{{"struck end", 6}, {"7", 7}}));
    const Measures<3> measures(*mesh);
    EXPECT_NEAR(measures.volume.at(10), 1, 1e-13);
    EXPECT_NEAR(measures.volume.at(20), 2, 1e-13);
    EXPECT_NEAR(measures.area.at(6), 1, 1e-13);
    EXPECT_NEAR(measures.area.at(7), 1, 1e-13);
    EXPECT_NEAR(measures.area.at(0), 12, 1e-13);
    EXPECT_EQ(mesh->remarks.size(), 1u);
    EXPECT_TRUE(has_remark(mesh->remarks,
                           "\"interface\" of the mesh file lies inside the body with 4 faces"));
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary())
          {
            const bool is_at_end = std::abs(cell->face(f)->center()[0]) < 1e-14;
            EXPECT_EQ(cell->face(f)->boundary_id() == 6, is_at_end);
          }
  }
}

TEST(FileMesh, nodes_have_the_same_ids_on_any_number_of_ranks)
{
  const MeshScene<3> model("file", "set File = " + meshes + "two_blocks_41.msh");
  const auto mesh = model.create_mesh();
  mesh->triangulation.repartition();
  // Creating it alone reads the file on each rank.
  const auto alone = model.create_mesh(MPI_COMM_SELF);
  EXPECT_EQ(nodes_by_id(Nodes<3>(*mesh, 2)), nodes_by_id(Nodes<3>(*alone, 2)));
}

TEST(FileMesh, reads_the_rod_of_the_parameter_files)
{
  const MeshScene<3> model(
      "file", "set File = " + source_directory() + "/parameter_files/elastic_wave/rod.msh",
      {{"steel", "group steel side"}, {"particles", "group particle side"}});
  const auto mesh = model.create_mesh();
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 1800u);
  const PartCells<3> part_cells(model.part_sections, *mesh);
  part_cells.check(mesh->triangulation);
  for (const auto &cell : mesh->triangulation.active_cell_iterators())
    if (cell->is_locally_owned())
    {
      EXPECT_EQ(part_cells.part_of(cell), cell->center()[0] < 5 ? 0u : 1u);
    }
  EXPECT_NEAR(Measures<3>(*mesh).area.at(mesh->boundary_names.at("struck end")), 1.44, 1e-13);
  EXPECT_EQ(mesh->boundary_names.count("interface"), 0u);
  EXPECT_TRUE(has_remark(mesh->remarks, "\"interface\""));
}

TEST(FileMesh, reads_a_plane_mesh_and_scales_it)
{
  const auto mesh = mesh_of<2>(meshes + "two_squares.msh", "set Scale = 0.5");
  EXPECT_EQ(mesh->triangulation.n_global_active_cells(), 2u);
  EXPECT_EQ(mesh->triangulation.n_vertices(), 6u);
  const Measures<2> measures(*mesh);
  EXPECT_NEAR(measures.volume.at(1), 0.25, 1e-14);
  EXPECT_NEAR(measures.volume.at(2), 0.25, 1e-14);
  EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("free edge")), 0.5, 1e-14);
  EXPECT_NEAR(measures.area.at(mesh->boundary_names.at("8")), 0.5, 1e-14);
  EXPECT_EQ(mesh->boundary_names.size(), 2u);
  EXPECT_TRUE(has_remark(mesh->remarks, "1 of 2 cells of the mesh file are numbered the wrong way "
                                        "round (the first on line 27)"));
  EXPECT_TRUE(has_remark(mesh->remarks, "\"seam\" of the mesh file lies inside the body"));
}

TEST(FileMesh, turns_inverted_hexahedra_and_says_so)
{
  const std::string text = read_text_file(meshes + "two_cubes.vtk");
  const TemporaryFile file(replaced(text, "8 1 8 9 2 5 10 11 6", "8 1 2 9 8 5 6 11 10"), ".vtk");
  const auto mesh = mesh_of<3>(file.path);
  EXPECT_TRUE(has_remark(mesh->remarks, "1 of 2 cells of the mesh file are numbered the wrong way "
                                        "round (the first on line 12)"));
  const Measures<3> measures(*mesh);
  EXPECT_NEAR(measures.volume.at(3), 1, 1e-14);
  EXPECT_NEAR(measures.volume.at(7), 1, 1e-14);
  EXPECT_TRUE(mesh_of<3>(meshes + "two_cubes.vtk")->remarks.empty());
}

TEST(FileMesh, reads_vtk_material_numbers)
{
  const Measures<3> measures(*mesh_of<3>(meshes + "two_cubes.vtk"));
  EXPECT_EQ(measures.volume.size(), 2u);
  EXPECT_NEAR(measures.volume.at(3), 1, 1e-14);
  EXPECT_NEAR(measures.volume.at(7), 1, 1e-14);

  std::string text = read_text_file(meshes + "two_cubes.vtk");
  text.erase(text.find("CELL_DATA"));
  const TemporaryFile file(text, ".vtk");
  EXPECT_TRUE(has_remark(mesh_of<3>(file.path)->remarks, "has no MaterialID"));
}

TEST(FileMesh, remarks_nodes_that_are_not_merged)
{
  std::string text = read_text_file(meshes + "two_cubes.vtk");
  text = replaced(text, "POINTS 12", "POINTS 16");
  text = replaced(text, "2 0 0  2 1 0  2 0 1  2 1 1",
                  "2 0 0  2 1 0  2 0 1  2 1 1\n1 0 0  1 1 0  1 0 1  1 1 1");
  text = replaced(text, "8 1 8 9 2 5 10 11 6", "8 12 8 9 13 14 10 11 15");
  const TemporaryFile file(text, ".vtk");
  EXPECT_TRUE(has_remark(mesh_of<3>(file.path)->remarks, "4 nodes of the mesh file lie where"));
}

TEST(FileMesh, is_found_beside_the_parameter_file_before_the_working_directory)
{
  const auto directory = std::filesystem::temp_directory_path() /
                         ("tombolo_" + std::to_string(dealii::Utilities::MPI::broadcast(
                                           MPI_COMM_WORLD, static_cast<int>(getpid()), 0)));
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
  {
    std::filesystem::create_directories(directory / "meshes");
    std::filesystem::copy_file(meshes + "two_cubes.vtk", directory / "meshes/beside.vtk");
    std::ofstream(directory / "scene.prm") << "subsection Mesh\nsubsection file\n"
                                              "set File = meshes/beside.vtk\nend\nend\n";
  }
  MPI_Barrier(MPI_COMM_WORLD);
  Parameters parameters(MPI_COMM_WORLD);
  parameters.read_file((directory / "scene.prm").string());
  parameters.handler().enter_subsection("Mesh");
  Registry<MeshSource<3>>::instance().declare_all(parameters.handler());
  parameters.handler().leave_subsection();
  parameters.assign();
  Mesh<3> mesh(MPI_COMM_WORLD);
  Registry<MeshSource<3>>::instance().create("file", parameters.section("Mesh/file"))->create(mesh);
  EXPECT_EQ(mesh.triangulation.n_global_active_cells(), 2u);
  MPI_Barrier(MPI_COMM_WORLD);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::remove_all(directory);
}

TEST(FileMesh, refuses_a_file_that_is_missing_empty_or_of_another_kind)
{
  const auto error_of_name = [](const std::string &name)
  { return input_error([&]() { mesh_of<3>(name); }); };
  const std::string missing = error_of_name("no_such_mesh.msh");
  for (const char *part : {"scene.prm:3", "no_such_mesh.msh", "There is no such file"})
    EXPECT_TRUE(contains(missing, part));
  EXPECT_TRUE(contains(error_of_name(meshes + "two_cubes.stl"), ".msh (gmsh) and .vtk (VTK"));
  for (const std::string deck : {"bar.inp", "bar.k", "bar.key", "bar.dyn"})
    EXPECT_TRUE(contains(error_of_name(deck),
                         "This is a deck. scripts/import " + deck + " makes a mesh of it"));
  EXPECT_TRUE(contains(error_of_file<3>("", ".msh"), "The file is empty"));
  EXPECT_TRUE(contains(error_of_file<3>(" \n\n", ".vtk"), "The file is empty"));
  EXPECT_TRUE(contains(input_error([]() { MeshScene<3>("file", "").create_mesh(); }), "File"));
  for (const std::string scale : {"0", "-1", "nan"})
    EXPECT_TRUE(contains(
        input_error([&]() { mesh_of<3>(meshes + "two_cubes.vtk", "set Scale = " + scale); }),
        "scene.prm:4"));
}

TEST(FileMesh, refuses_bad_files_of_gmsh_with_line_and_remedy)
{
  const std::string text = read_text_file(meshes + "two_blocks_22.msh");
  const std::string text41 = read_text_file(meshes + "two_blocks_41.msh");
  const std::string plane = read_text_file(meshes + "two_squares.msh");
  const std::string no_cells =
      text.substr(0, text.find("$Elements")) + "$Elements\n1\n1 3 2 6 1 1 3 4 2\n$EndElements\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {replaced(text, "2.2 0 8", "2.2 1 8"), "The number 1 does not stand here"},
      {replaced(text, "2.2 0 8", "2.2 1 4"), "line 2: Numbers of 4 bytes are not allowed"},
      {replaced(text, "2.2 0 8", "2.2 2 8"), "line 2: \"2\" stands where the kind of file should"},
      {replaced(text, "2.2 0 8", "4.0 0 8"),
       "version 4.0 of gmsh's format. Allowed are 2.2 and 4.1: save it anew with \"gmsh -save FILE "
       "-format msh41 -o NEW.msh"},
      {"solid\n", "line 1: A file of gmsh begins with $MeshFormat"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "There is no section $Nodes"},
      {text.substr(0, text.find("$EndElements")), "The file ends where $EndElements should stand"},
      {text.substr(0, text.find("$EndNodes")), "The file ends where $EndNodes should stand"},
      {replaced(text, "$EndNodes", "1.5"), "\"1.5\" stands where $EndNodes should"},
      {no_cells, "there are no hexahedra"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 4 2 6 1 1 3 4 2"),
       "There are tetrahedra. Allowed are hexahedra only. In gmsh, set Mesh.SubdivisionAlgorithm = "
       "2"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 2 2 6 1 1 3 4"),
       "There are triangles on a surface"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 93 2 6 1 1 3 4"), "type 93 are not allowed"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 5 2 6 1 1 3 4 2 1 3 4 x"),
       "\"x\" stands where the number of a node should"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 5 2 6 1 1 3 4 2 1 3 4 999"),
       "There is no node of number 999"},
      {replaced(no_cells, "1 3 2 6 1 1 3 4 2", "1 5 2 6 1 1 3 4 2 1 3 4 5"),
       "A cell has the same node twice"},
      {replaced(text, "\n2 0 1 0\n", "\n2 0 nan 0\n"), "\"nan\" is not finite"},
      {replaced(text, "\n2 0 1 0\n", "\n1 0 1 0\n"), "There are two nodes of number 1"},
      {replaced(text41, "$Entities", "$PartitionedEntities"), "The mesh is partitioned"},
      {plane, "there are no hexahedra"},
  };
  for (const auto &[bad, message] : cases)
  {
    const std::string error = error_of_file<3>(bad, ".msh");
    EXPECT_TRUE(contains(error, message));
    EXPECT_TRUE(contains(error, "scene.prm:3"));
  }

  const std::vector<std::pair<std::string, std::string>> plane_cases = {
      {text, "There are hexahedra, and the scene has two dimensions"},
      {replaced(plane, "6 2 1 0", "6 2 1 0.5"), "does not lie in the x-y plane"},
      {replaced(plane, "6 2 1 0", "6 1 0.5 0"), "line 27: A cell is twisted"},
      {replaced(plane, "6 3 2 2 2 2 5 6 3", "6 3 2 1 1 1 2 5 4"),
       "line 27: The cell stands on line 26 already"},
      {replaced(plane, "4 1 2 8 3 1 2", "4 1 2 8 3 1 3"), "line 25: A face of \"8\" is no face"},
  };
  for (const auto &[bad, message] : plane_cases)
    EXPECT_TRUE(contains(error_of_file<2>(bad, ".msh"), message));
}

TEST(FileMesh, refuses_bad_files_of_vtk_with_line_and_remedy)
{
  const std::string text = read_text_file(meshes + "two_cubes.vtk");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {replaced(text, "3.0", "5.1"), "line 1: This is version 5.1 of the legacy VTK format"},
      {replaced(text, "ASCII", "BINARY"), "line 3: \"BINARY\" stands where ASCII should"},
      {replaced(text, "UNSTRUCTURED_GRID", "POLYDATA"), "Allowed is DATASET UNSTRUCTURED_GRID"},
      {replaced(text, "MaterialID", "Region"), "\"SCALARS Region int\" are not allowed"},
      {replaced(text, "SCALARS MaterialID int", "SCALARS MaterialID double"), "are not allowed"},
      {replaced(text, "CELL_DATA", "POINT_DATA"), "\"POINT_DATA\" is not allowed here"},
      {replaced(text, "\n12\n12", "\n12\n10"), "A cell is of VTK's type 10. Allowed are only "
                                               "hexahedra, type 12"},
      {replaced(text, "8 0 1 2 3 4 5 6 7", "4 0 1 2 3"), "line 11: A cell has 4 points"},
      {replaced(text, "10 11 6", "10 12 6"), "There is no point of number 12: there are 12"},
      {replaced(text, "2 0 0  2 1 0  2 0 1  2 1 1", "1 0 0  1 1 0  1 0 1  1 1 1"),
       "line 12: A cell is flat"},
      {text.substr(0, text.find("CELL_TYPES")), "There are no CELL_TYPES"},
      {"<VTKFile>\n", "line 1: A legacy VTK file begins with"},
  };
  for (const auto &[bad, message] : cases)
    EXPECT_TRUE(contains(error_of_file<3>(bad, ".vtk"), message));
  EXPECT_TRUE(contains(error_of_file<2>(text, ".vtk"), "Allowed are only quadrilaterals, of 4"));
}
