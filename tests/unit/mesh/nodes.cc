// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <deal.II/base/mpi.h>

#include <tombolo/mesh/part_cells.h>

#include <mesh_testing.h>

#include <algorithm>
#include <numeric>
#include <set>

using namespace tombolo;
using namespace tombolo::testing;

namespace
{
  const std::string block = "set Upper corner = 4, 2, 2\nset Cells = 12, 4, 4\n";
  const std::string turned_plate =
      "set Upper corner = 4, 2\nset Cells = 12, 8\nset Rotation = 20\n";

  /** For balance(): the same work for all cells of a part. */
  std::vector<std::function<StepCost(double)>> constant(const std::vector<double> &work_of_part)
  {
    std::vector<std::function<StepCost(double)>> functions;
    for (const double work : work_of_part)
      functions.push_back([work](const double /*box_ratio*/) { return StepCost{work, 0.}; });
    return functions;
  }

  template <int dim>
  void expect_same_ids_on_one_rank(const std::string &entries, const unsigned int degree,
                                   const std::size_t n_nodes)
  {
    const MeshScene<dim> model("box", entries, {{"left", "x < 2"}, {"right", "otherwise"}});
    const auto mesh = model.create_mesh();
    const auto alone = model.create_mesh(MPI_COMM_SELF);
    const auto expected = nodes_by_id(Nodes<dim>(*alone, degree));
    EXPECT_EQ(expected.size(), n_nodes);
    EXPECT_EQ(nodes_by_id(Nodes<dim>(*mesh, degree)), expected);

    const PartCells<dim> part_cells(model.part_sections, *mesh);
    balance(*mesh, part_cells, constant({1., 7.}));
    EXPECT_EQ(nodes_by_id(Nodes<dim>(*mesh, degree)), expected);
  }
} // namespace

TEST(Nodes, have_unique_ids_that_do_not_depend_on_the_partition)
{
  expect_same_ids_on_one_rank<3>(block, 1, 13 * 5 * 5);
  expect_same_ids_on_one_rank<3>(block, 2, 25 * 9 * 9);
  expect_same_ids_on_one_rank<3>(block + "set Disorder = 0.1", 1, 13 * 5 * 5);
  expect_same_ids_on_one_rank<2>(turned_plate, 1, 13 * 9);
  expect_same_ids_on_one_rank<2>(turned_plate, 3, 37 * 25);
}

TEST(Nodes, of_a_locally_refined_mesh_have_unique_ids)
{
  const MeshScene<2> model("box", "set Upper corner = 4, 2\nset Cells = 4, 2");
  const auto refine = [](Mesh<2> &mesh)
  {
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned() && cell->center()[0] < 1)
        cell->set_refine_flag();
    mesh.triangulation.execute_coarsening_and_refinement();
  };
  const auto mesh = model.create_mesh();
  const auto alone = model.create_mesh(MPI_COMM_SELF);
  refine(*mesh);
  refine(*alone);
  // 3 x 5 nodes in the refined column and 3 x 3 in the others.
  const auto expected = nodes_by_id(Nodes<2>(*alone, 1));
  EXPECT_EQ(expected.size(), 3u * 5u + 3u * 3u);
  EXPECT_EQ(nodes_by_id(Nodes<2>(*mesh, 1)), expected);
}

TEST(Nodes, of_a_cell_are_lexicographic_and_lie_on_gauss_lobatto_points)
{
  const auto mesh =
      MeshScene<3>("box", "set Upper corner = 4, 2, 3\nset Cells = 2, 2, 2").create_mesh();
  const Nodes<3> nodes(*mesh, 3);
  EXPECT_EQ(nodes.degree(), 3u);
  const double inner = (1 - std::sqrt(0.2)) / 2;
  const double coordinates[] = {0, inner, 1 - inner, 1};
  std::vector<dealii::types::global_dof_index> numbers;
  std::vector<dealii::Point<3>> points;
  for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    if (cell->is_locally_owned())
    {
      nodes.cell_nodes(cell, numbers);
      nodes.cell_points(cell, points);
      ASSERT_EQ(numbers.size(), 64u);
      ASSERT_EQ(points.size(), 64u);
      for (unsigned int k = 0; k < 64; ++k)
      {
        EXPECT_TRUE(nodes.relevant().is_element(numbers[k]));
        const auto corner = cell->vertex(0);
        EXPECT_NEAR(points[k][0], corner[0] + 2. * coordinates[k % 4], 1e-14);
        EXPECT_NEAR(points[k][1], corner[1] + 1. * coordinates[k / 4 % 4], 1e-14);
        EXPECT_NEAR(points[k][2], corner[2] + 1.5 * coordinates[k / 16], 1e-14);
      }
    }
}

TEST(Nodes, relevant_ones_are_the_owned_and_those_of_owned_cells)
{
  const auto mesh = MeshScene<3>("box", block).create_mesh();
  const Nodes<3> nodes(*mesh, 1);
  std::set<dealii::types::global_dof_index> expected(nodes.owned().begin(), nodes.owned().end());
  std::vector<dealii::types::global_dof_index> numbers;
  for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    if (cell->is_locally_owned())
    {
      nodes.cell_nodes(cell, numbers);
      expected.insert(numbers.begin(), numbers.end());
    }
  const std::set<dealii::types::global_dof_index> relevant(nodes.relevant().begin(),
                                                           nodes.relevant().end());
  EXPECT_EQ(relevant, expected);
  EXPECT_EQ(nodes.relevant().size(), 13u * 5u * 5u);
  EXPECT_EQ(dealii::Utilities::MPI::sum(nodes.owned().n_elements(), MPI_COMM_WORLD), 13u * 5u * 5u);
}

TEST(PartitionWeights, give_all_ranks_the_same_work)
{
  const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const MeshScene<3> model("box", "set Upper corner = 10, 1.2, 1.2\nset Cells = 50, 6, 6",
                           {{"steel side", "x < 5"}, {"particle side", "otherwise"}});
  const std::vector<double> work = {1., 9.};
  const auto mesh = model.create_mesh();
  const PartCells<3> part_cells(model.part_sections, *mesh);
  part_cells.check(mesh->triangulation);

  const auto shares = [&]()
  {
    double mine = 0;
    for (const auto &cell : mesh->triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        mine += work[part_cells.part_of(cell)];
    return dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, mine / (900. * 10.));
  };
  // Equal numbers of cells leave almost all of the work to the ranks of the particles.
  if (n_ranks == 2)
  {
    const auto before = shares();
    EXPECT_GT(*std::max_element(before.begin(), before.end()), 0.7);
  }
  balance(*mesh, part_cells, constant(work));
  part_cells.check(mesh->triangulation);
  const auto after = shares();
  EXPECT_NEAR(std::accumulate(after.begin(), after.end(), 0.), 1., 1e-12);
  EXPECT_LE(*std::max_element(after.begin(), after.end()), n_ranks == 1 ? 1.0001 : 1.1 / n_ranks);
}
