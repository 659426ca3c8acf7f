// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/selected_lanes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace
{
  using namespace tombolo;

  constexpr unsigned int n_nodes = 61, node_size = 4;

  struct NodeLanesTest : ::testing::Test
  {
    NodeLanesTest()
    {
      for (unsigned int i = 0; i < field.size(); ++i)
        field[i] = std::sin(i + 1.);
      for (unsigned int lane = 0; lane < indices.size(); ++lane)
        indices[lane] = 7 * lane % n_nodes;
    }

    std::array<double, n_nodes * node_size> field;
    std::array<unsigned int, 2 * n_lanes> indices;
  };

  template <int dim>
  void check_gather_and_add(const std::array<double, n_nodes * node_size> &field,
                            const std::array<unsigned int, 2 * n_lanes> &indices)
  {
    Lanes components[dim];
    gather_nodes(field.data(), indices.data(), components);
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      for (unsigned int d = 0; d < dim; ++d)
        EXPECT_EQ(components[d][lane], field[node_size * indices[lane] + d]);

    for (unsigned int n_valid = 1; n_valid <= n_lanes; ++n_valid)
    {
      std::array<double, n_nodes *node_size> sum = field, expected = field;
      add_to_nodes(components, indices.data(), n_valid, sum.data());
      for (unsigned int lane = 0; lane < n_valid; ++lane)
        for (unsigned int d = 0; d < dim; ++d)
          expected[node_size * indices[lane] + d] *= 2.;
      EXPECT_EQ(sum, expected) << n_valid;
    }
  }

  TEST_F(NodeLanesTest, nodes_are_gathered_and_added_to)
  {
    check_gather_and_add<2>(field, indices);
    check_gather_and_add<3>(field, indices);
  }

  TEST_F(NodeLanesTest, a_node_that_repeats_is_added_to_each_time)
  {
    indices.fill(3);
    Lanes components[3] = {1., 2., 3.};
    std::array<double, n_nodes *node_size> sum = {};
    add_to_nodes(components, indices.data(), n_lanes, sum.data());
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_EQ(sum[3 * node_size + d], n_lanes * (d + 1.));
    EXPECT_EQ(sum[3 * node_size + 3], 0.);
  }

  TEST_F(NodeLanesTest, components_are_permuted_and_broadcast)
  {
    const NodeLanes permuted = permute<1, 2, 0, 3>(node_of(1., 2., 3.));
    const NodeLanes broadcast = broadcast_in_register(0.1);
    const std::array<double, node_size> expected = {{2., 3., 1., 0.}};
    for (unsigned int i = 0; i < node_size; ++i)
    {
      EXPECT_EQ(permuted[i], expected[i]);
      EXPECT_EQ(broadcast[i], 0.1);
    }
  }

  TEST_F(NodeLanesTest, numbers_of_set_lanes_are_stored)
  {
    const LaneMask mask = load_lanes(field.data()) > load_lanes(field.data() + n_lanes);
    for (unsigned int n = 1; n <= n_lanes + 1; ++n)
    {
      std::array<unsigned int, 2 + n_lanes> out = {};
      const SelectedLanes selected(mask, n);
      selected.store(indices.data(), out.data() + 2);
      const unsigned int count = 2 + selected.count();
      unsigned int expected_count = 2;
      for (unsigned int lane = 0; lane < std::min(n, n_lanes); ++lane)
        if (field[lane] > field[n_lanes + lane])
        {
          EXPECT_EQ(out[expected_count], indices[lane]);
          ++expected_count;
        }
      EXPECT_EQ(count, expected_count);
    }
  }
} // namespace
