// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <tombolo/remesh/node_maxima.h>

#include "remap_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  constexpr double width_of_maxima = 7., height_of_maxima = 5.;

  double value_of_cell(const Point<2> &middle)
  {
    return std::sin(3.1 * middle[0] + 5.3 * middle[1]);
  }

  /** The largest of the values of the cells around a node as far as @p end; @p nothing without any.
   */
  double expected_at(const double *const x, const double end, const double nothing)
  {
    double result = nothing;
    for (const double dx : {-0.5, 0.5})
      for (const double dy : {-0.5, 0.5})
      {
        const Point<2> middle(x[0] + dx, x[1] + dy);
        if (middle[0] > 0. && middle[0] < end && middle[1] > 0. && middle[1] < height_of_maxima)
          result = std::max(result, value_of_cell(middle));
      }
    return result;
  }

  TEST(NodeMaxima, are_the_largest_of_the_cells_around_a_node_of_whatever_rank)
  {
    RemapBody<2> body({7, 5});
    const std::vector<Point<2>> middles = body.middles_of_lattice();
    for (const double end : {width_of_maxima, 3.})
    {
      const double nothing = -2.;
      NodeMaxima maxima(body.partition, nothing);
      for (std::size_t c = 0; c < middles.size(); ++c)
        if (middles[c][0] < end)
          for (const unsigned int node : body.nodes_of_cells()[c])
            maxima.raise(node, value_of_cell(middles[c]));
      maxima.share();
      for (unsigned int i = 0; i < body.partition->n_owned() + body.partition->n_ghosts(); ++i)
        EXPECT_NEAR(maxima[i], expected_at(body.lattice.node(i), end, nothing), 1e-12) << i;
      for (std::size_t c = 0; c < middles.size(); ++c)
      {
        double largest = nothing;
        for (const unsigned int node : body.nodes_of_cells()[c])
          largest = std::max(largest, expected_at(body.lattice.node(node), end, nothing));
        EXPECT_NEAR(maxima.largest_of(body.nodes_of_cells()[c]), largest, 1e-12) << middles[c];
      }
    }
  }
} // namespace
