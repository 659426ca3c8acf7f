// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/mesh/bodies.h>
#include <tombolo/mesh/mesh.h>

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace
{
  using namespace tombolo;

  /** Cells of a row of ten, which ranks share, without those for which @p is_missing holds. */
  template <typename Predicate>
  void make_row(Mesh<2> &mesh, const Predicate &is_missing)
  {
    std::vector<dealii::Point<2>> vertices;
    std::vector<dealii::CellData<2>> cells;
    for (unsigned int j = 0; j < 2; ++j)
      for (unsigned int i = 0; i <= 10; ++i)
        vertices.emplace_back(i, j);
    for (unsigned int i = 0; i < 10; ++i)
      if (!is_missing(i))
      {
        dealii::CellData<2> cell;
        cell.vertices = {i, i + 1, i + 11, i + 12};
        cells.push_back(cell);
      }
    std::vector<dealii::Point<2>> used;
    std::vector<unsigned int> number(vertices.size(), dealii::numbers::invalid_unsigned_int);
    for (auto &cell : cells)
      for (unsigned int &vertex : cell.vertices)
      {
        if (number[vertex] == dealii::numbers::invalid_unsigned_int)
        {
          number[vertex] = static_cast<unsigned int>(used.size());
          used.push_back(vertices[vertex]);
        }
        vertex = number[vertex];
      }
    mesh.triangulation.create_triangulation(used, cells, {});
  }

  unsigned int n_bodies(const std::vector<unsigned int> &missing)
  {
    Mesh<2> mesh(MPI_COMM_WORLD);
    make_row(mesh, [&](const unsigned int i)
             { return std::count(missing.begin(), missing.end(), i) > 0; });
    const Nodes<2> nodes(mesh, 1);
    const Bodies<2> bodies(nodes);
    // All nodes of a cell are of one body.
    std::vector<dealii::types::global_dof_index> cell_numbers;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      if (cell->is_locally_owned())
      {
        nodes.cell_nodes(cell, cell_numbers);
        for (const auto node : cell_numbers)
          EXPECT_EQ(bodies.body_of(node), bodies.body_of(cell_numbers.front()));
      }
    return bodies.n_bodies();
  }
} // namespace

TEST(Bodies, are_counted_over_all_ranks)
{
  EXPECT_EQ(n_bodies({}), 1u);
  EXPECT_EQ(n_bodies({4}), 2u);
  EXPECT_EQ(n_bodies({1, 3, 5, 7}), 5u);
  EXPECT_EQ(n_bodies({2, 3, 4, 5, 6}), 2u);
}
