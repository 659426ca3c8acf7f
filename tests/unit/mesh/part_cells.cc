// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <deal.II/base/mpi.h>

#include <mesh_testing.h>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  using Parts = std::vector<std::pair<std::string, std::string>>;

  const std::string strip_of_cells = "set Upper corner = 10, 1\nset Cells = 20, 2\n";

  /** The numbers of cells of each part. */
  std::vector<unsigned int> cells_of(const Parts &parts, const Mesh<2> &mesh,
                                     const MeshScene<2> &model)
  {
    const PartCells<2> part_cells(model.part_sections, mesh);
    part_cells.check(mesh.triangulation);
    std::vector<unsigned int> n_cells(parts.size(), 0);
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        ++n_cells[part_cells.part_of(cell)];
    dealii::Utilities::MPI::sum(n_cells, MPI_COMM_WORLD, n_cells);
    return n_cells;
  }

  std::vector<unsigned int> cells_of(const Parts &parts)
  {
    const MeshScene<2> model("box", strip_of_cells, parts);
    return cells_of(parts, *model.create_mesh(), model);
  }

  /** A mesh whose cells with x > 8 are of the group "foot" and of material 4. */
  std::unique_ptr<Mesh<2>> mesh_with_group(const MeshScene<2> &model)
  {
    auto mesh = model.create_mesh();
    for (const auto &cell : mesh->triangulation.cell_iterators())
      if (cell->center()[0] > 8)
        cell->set_material_id(4);
    mesh->group_names["foot"] = 4;
    mesh->group_names["nothing"] = 5;
    return mesh;
  }

  std::vector<unsigned int> cells_of_groups(const Parts &parts)
  {
    const MeshScene<2> model("box", strip_of_cells, parts);
    return cells_of(parts, *mesh_with_group(model), model);
  }

  std::string error_of(const Parts &parts)
  {
    return input_error([&]() { cells_of_groups(parts); });
  }
} // namespace

TEST(PartCells, are_chosen_by_predicate_and_the_rest)
{
  EXPECT_EQ(cells_of({{"left", "x < 5"}, {"right", "otherwise"}}),
            (std::vector<unsigned int>{20, 20}));
  EXPECT_EQ(cells_of({{"rest", "otherwise"}, {"one", "x < 1 && y > 0.5"}, {"two", "x > 9"}}),
            (std::vector<unsigned int>{34, 2, 4}));
  EXPECT_EQ(cells_of({{"body", "all"}}), (std::vector<unsigned int>{40}));
}

TEST(PartCells, are_chosen_by_material_and_group)
{
  EXPECT_EQ(cells_of_groups({{"foot", "group foot"}, {"rest", "material 0"}}),
            (std::vector<unsigned int>{8, 32}));
  EXPECT_EQ(cells_of_groups({{"foot", "material 4"}, {"rest", "otherwise"}}),
            (std::vector<unsigned int>{8, 32}));
}

TEST(PartCells, in_no_part_or_in_two_are_named_with_their_place)
{
  const std::string gap = error_of({{"left", "x < 4"}, {"right", "x > 6"}});
  for (const char *part :
       {"(4.25, 0.25) is in no part (8 cells in all)", "\"otherwise\"", "scene.prm:"})
    EXPECT_TRUE(contains(gap, part));

  const std::string overlap = error_of({{"left", "x < 6"}, {"right", "x > 5"}});
  for (const char *part : {"(5.25, 0.25) is in two parts, \"left\" and \"right\" (4 cells in all)",
                           "\"otherwise\"", "scene.prm:"})
    EXPECT_TRUE(contains(overlap, part));
  EXPECT_TRUE(contains(error_of({{"left", "x < 6"}, {"right", "all"}}),
                       "is in two parts, \"left\" and \"right\""));
}

TEST(PartCells, rules_that_select_nothing_are_refused)
{
  const std::string nothing = error_of({{"left", "x < -5"}, {"right", "otherwise"}});
  for (const char *part :
       {"selects no cell of the mesh", "centre of none of its 40 cells", "\"left\"", "scene.prm:"})
    EXPECT_TRUE(contains(nothing, part));
  EXPECT_TRUE(contains(error_of({{"left", "x < 50"}, {"right", "otherwise"}}),
                       "No cells are left for the part \"right\""));
  EXPECT_TRUE(contains(error_of({{"left", "material 7"}, {"right", "otherwise"}}),
                       "no cells of this material; the largest number in it is 4"));
  EXPECT_TRUE(contains(error_of({{"left", "group nothing"}, {"right", "otherwise"}}),
                       "no cells of this material"));
}

TEST(PartCells, rules_that_cannot_be_read_are_refused)
{
  const std::string group = error_of({{"left", "group fot"}, {"right", "otherwise"}});
  for (const char *part : {"no group \"fot\"", "mean \"foot\"", "\"nothing\"", "scene.prm:"})
    EXPECT_TRUE(contains(group, part));
  EXPECT_TRUE(contains(error_of({{"left", "material two"}, {"right", "otherwise"}}),
                       "\"two\" is not a material number"));
  EXPECT_TRUE(contains(error_of({{"left", "otherwise"}, {"right", "otherwise"}}),
                       "\"left\" takes the other cells already"));
  EXPECT_TRUE(contains(error_of({{"left", ""}, {"right", "otherwise"}}), "are not given"));
  EXPECT_TRUE(contains(error_of({{"left", "x <"}, {"right", "otherwise"}}), "scene.prm:"));
  EXPECT_TRUE(contains(input_error(
                           []() {
                             cells_of({{"left", "group foot"}});
                           }),
                       "The mesh has no groups of cells"));
}

TEST(PartCells, a_predicate_that_is_not_finite_somewhere_is_refused_by_all_ranks)
{
  EXPECT_NE(error_of({{"left", "sqrt(9.5 - x)"}, {"right", "otherwise"}}), "");
}
