// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <gtest/gtest.h>

#include <tombolo/base/ordered_sum.h>

namespace
{
  using tombolo::ordered_sum;

  double contribution(const int rank)
  {
    return rank == 0 ? 1e16 : rank == 1 ? 1. : -1e16;
  }

  TEST(OrderedSum, adds_in_the_order_of_ranks_on_every_rank)
  {
    int rank = 0;
    int n_ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
    // (1e16 + 1) - 1e16 is 0 in this order, and 1 in another.
    double expected = contribution(0);
    for (int r = 1; r < n_ranks; ++r)
      expected += contribution(r);
    EXPECT_EQ(ordered_sum(contribution(rank), MPI_COMM_WORLD), expected);
    EXPECT_EQ(ordered_sum(std::vector<double>{contribution(rank), 1.}, MPI_COMM_WORLD),
              (std::vector<double>{expected, static_cast<double>(n_ranks)}));
    EXPECT_TRUE(ordered_sum(std::vector<double>(), MPI_COMM_WORLD).empty());
  }
} // namespace
