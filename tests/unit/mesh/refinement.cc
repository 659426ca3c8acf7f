// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/mesh/mesh.h>
#include <tombolo/mesh/refinement.h>

#include <mesh_testing.h>

#include <algorithm>
#include <map>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  /** A box with entries of section Mesh beside those of its own. */
  template <int dim>
  class RefinedBox
  {
  public:
    RefinedBox(const std::string &box_entries, const std::string &mesh_entries)
        : parameters(MPI_COMM_WORLD)
    {
      parameters.read_text("subsection Mesh\n" + mesh_entries + "\nsubsection box\n" + box_entries +
                               "\nend\nend\n",
                           "scene.prm");
      auto &handler = parameters.handler();
      handler.enter_subsection("Mesh");
      declare<MeshRefinement<dim>>(handler);
      Registry<MeshSource<dim>>::instance().declare_all(handler);
      handler.leave_subsection();
      parameters.assign();
    }

    std::unique_ptr<Mesh<dim>> create(MPI_Comm communicator = MPI_COMM_WORLD) const
    {
      const MeshRefinement<dim> refinement(parameters.section("Mesh"));
      auto mesh = std::make_unique<Mesh<dim>>(communicator);
      Registry<MeshSource<dim>>::instance()
          .create("box", parameters.section("Mesh/box"))
          ->create(*mesh);
      refinement.refine(*mesh);
      return mesh;
    }

  private:
    Parameters parameters;
  };

  template <int dim>
  std::vector<unsigned int> cells_of_levels(const Mesh<dim> &mesh)
  {
    std::vector<unsigned int> result(mesh.triangulation.n_global_levels(), 0);
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        ++result[cell->level()];
    dealii::Utilities::MPI::sum(result, communicator_of(mesh.triangulation), result);
    return result;
  }

  /** The largest difference of levels of cells that meet at a vertex. */
  template <int dim>
  int largest_jump(const Mesh<dim> &mesh)
  {
    std::map<unsigned int, std::pair<int, int>> levels; // of the cells at a vertex
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        for (const unsigned int v : cell->vertex_indices())
        {
          auto &found =
              levels.emplace(cell->vertex_index(v), std::make_pair(cell->level(), cell->level()))
                  .first->second;
          found = {std::min(found.first, cell->level()), std::max(found.second, cell->level())};
        }
    int jump = 0;
    for (const auto &vertex : levels)
      jump = std::max(jump, vertex.second.second - vertex.second.first);
    return dealii::Utilities::MPI::max(jump, communicator_of(mesh.triangulation));
  }

  const std::string cube = "set Upper corner = 5, 5, 5\nset Cells = 5, 5, 5";

  TEST(MeshRefinement, halves_the_cells_whose_centres_are_in_a_region)
  {
    const auto plane =
        RefinedBox<2>("set Upper corner = 5, 5\nset Cells = 5, 5", "set Refine where = x < 2")
            .create();
    EXPECT_EQ(cells_of_levels(*plane), (std::vector<unsigned int>{15, 40}));
    const auto solid = RefinedBox<3>(cube, "set Refine where = x < 2 && y < 1").create();
    EXPECT_EQ(cells_of_levels(*solid), (std::vector<unsigned int>{115, 80}));
    // A box that its source has refined already.
    const auto twice =
        RefinedBox<2>("set Upper corner = 4, 4\nset Cells = 4, 4", "set Refine where = x < 1")
            .create();
    EXPECT_EQ(cells_of_levels(*twice), (std::vector<unsigned int>{0, 0, 12, 16}));
  }

  TEST(MeshRefinement, keeps_one_level_between_cells_that_meet_at_a_corner)
  {
    const auto mesh =
        RefinedBox<3>(cube, "set Refine where = x > 2 && x < 3 && y > 2 && y < 3 && z "
                            "> 2 && z < 3; x + y + z < 1.6\n"
                            "set Refinement levels = 1; 3")
            .create();
    EXPECT_EQ(largest_jump(*mesh), 1);
    EXPECT_EQ(cells_of_levels(*mesh).size(), 4u);
    double volume = 0;
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        volume += cell->measure();
    EXPECT_NEAR(dealii::Utilities::MPI::sum(volume, MPI_COMM_WORLD), 125., 1e-10);
  }

  TEST(MeshRefinement, gives_the_same_nodes_on_all_rank_counts)
  {
    const RefinedBox<3> box(cube + "\nset Disorder = 0.2",
                            "set Refine where = x < 2 && y + z > 3; z < 1\n"
                            "set Refinement levels = 2; 1");
    const auto mesh = box.create();
    const auto alone = box.create(MPI_COMM_SELF);
    EXPECT_EQ(cells_of_levels(*mesh), cells_of_levels(*alone));
    const auto nodes = nodes_by_id(Nodes<3>(*mesh, 1));
    const auto expected = nodes_by_id(Nodes<3>(*alone, 1));
    ASSERT_EQ(nodes.size(), expected.size());
    for (const auto &[id, position] : expected)
      for (unsigned int d = 0; d < 3; ++d)
        EXPECT_NEAR(nodes.at(id)[d], position[d], 1e-14);
  }

  TEST(MeshRefinement, keeps_the_boundaries_of_the_source)
  {
    const auto mesh = RefinedBox<3>(cube, "set Refine where = y < 2").create();
    std::vector<double> areas(6, 0.);
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int face : cell->face_indices())
          if (cell->at_boundary(face))
            areas.at(cell->face(face)->boundary_id()) += cell->face(face)->measure();
    dealii::Utilities::MPI::sum(areas, MPI_COMM_WORLD, areas);
    for (const double area : areas)
      EXPECT_NEAR(area, 25., 1e-10);
  }

  std::string refused(const std::string &mesh_entries, const std::string &box_entries = cube)
  {
    return input_error([&] { RefinedBox<3>(box_entries, mesh_entries).create(); });
  }

  TEST(MeshRefinement, refuses_what_is_no_refinement)
  {
    const char *const cases[][2] = {
        {"x < -1", "This is true at the centre of none of the 125 cells of the source"},
        {"x < 1; y > 7\nset Refinement levels = 1; 1", "Predicate 2 is true at the centre of none"},
        {"x < 1\nset Refinement levels = 0",
         "Allowed is a whole number from 1 to 12: the mesh of the source is the coarsest"},
        {"x < 1\nset Refinement levels = -1", "\"-1\" is not a number of levels"},
        {"x < 1; y < 1\nset Refinement levels = 2",
         "There must be a number for each predicate of `Refine where`, separated by \";\": 2, "
         "found 1."},
        {"x < t", "cannot depend on t"},
        {"x - 1", "compared with nothing"},
        {"x <", "this is not an expression"},
        {"(x < 1) + 0/(x - 0.5)", "is not finite"},
        {"x < 9\nset Refinement levels = 13",
         "there would be 13 below its coarse cells, and at most 12 are possible"}};
    for (const auto &[entries, message] : cases)
      EXPECT_TRUE(contains(refused(std::string("set Refine where = ") + entries), message));
  }

  TEST(MeshRefinement, refuses_levels_that_exceed_memory_before_it_refines)
  {
    const std::string message = refused("set Refine where = x < 2\nset Refinement levels = 11");
    EXPECT_TRUE(contains(message, "entry \"Mesh/Refinement levels\" = \"11\""));
    // 50 cells with 8^11 in each, and 75 as they are.
    EXPECT_TRUE(contains(message, "A mesh of 4.29e+11 cells needs more memory than there is"));
  }
} // namespace
