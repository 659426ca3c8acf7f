// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/mesh/cell_quality.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace
{
  using namespace tombolo;
  using namespace dealii;

  /** A cuboid by its centre and half of its edges. */
  template <int dim>
  CellVertices<dim> cuboid(const Point<dim> &centre, const std::array<Tensor<1, dim>, dim> &halves)
  {
    CellVertices<dim> result;
    for (unsigned int v = 0; v < result.size(); ++v)
    {
      result[v] = centre;
      for (unsigned int d = 0; d < dim; ++d)
        result[v] += ((v >> d) & 1u ? 1. : -1.) * halves[d];
    }
    return result;
  }
} // namespace

TEST(ConvexHulls, of_bars_that_cross_have_points_in_common_without_a_corner_inside)
{
  const auto lying = cuboid<2>({2., 0.5}, {{Tensor<1, 2>({2., 0.}), Tensor<1, 2>({0., 0.5})}});
  for (const double angle : {0., 0.3, -0.6})
  {
    const Tensor<1, 2> along({std::sin(angle), std::cos(angle)}), across({along[1], -along[0]});
    const auto bar = [&](const double x, const double y) {
      return cuboid<2>({x, y}, {{0.5 * across, 2. * along}});
    };
    EXPECT_TRUE(have_points_in_common<2>(lying, bar(1., 0.7))) << angle;
    EXPECT_TRUE(have_points_in_common<2>(bar(1., 0.7), lying)) << angle;
    EXPECT_FALSE(have_points_in_common<2>(lying, bar(6., 0.7))) << angle;
    EXPECT_FALSE(have_points_in_common<2>(lying, bar(1., 4.))) << angle;
  }
}

TEST(ConvexHulls, of_cells_that_touch_have_none_once_they_have_shrunk)
{
  const auto at = [](const double x, const double y) {
    return cuboid<2>({x, y}, {{Tensor<1, 2>({0.5, 0.}), Tensor<1, 2>({0., 0.5})}});
  };
  EXPECT_TRUE(have_points_in_common<2>(at(0., 0.), at(1., 0.3)));
  for (const double depth : {0.19, 0.21})
    EXPECT_EQ(have_points_in_common<2>(shrunk_corners<2>(at(0., 0.), 0.2),
                                       shrunk_corners<2>(at(1. - depth, 0.3), 0.2)),
              depth > 0.2);
}

TEST(ConvexHulls, in_space_can_lie_beside_each_other_along_two_edges)
{
  const auto cube = cuboid<3>(
      {0.5, 0.5, 0.5},
      {{Tensor<1, 3>({0.5, 0., 0.}), Tensor<1, 3>({0., 0.5, 0.}), Tensor<1, 3>({0., 0., 0.5})}});
  // An edge along (1, 1, -1), next to that of the cube along x.
  const Tensor<1, 3> edge = Tensor<1, 3>({1., 1., -1.}) / std::sqrt(3.),
                     apart = Tensor<1, 3>({0., 1., 1.}) / std::sqrt(2.),
                     third = cross_product_3d(edge, apart);
  for (const double gap : {0.01, -0.01})
  {
    const Point<3> centre = Point<3>(0.5, 1., 1.) + (std::sqrt(0.5) + gap) * apart;
    const auto turned = cuboid<3>(centre, {{0.5 * edge, 0.5 * std::sqrt(0.5) * (apart + third),
                                            0.5 * std::sqrt(0.5) * (apart - third)}});
    EXPECT_EQ(have_points_in_common<3>(cube, turned), gap < 0.);
    EXPECT_EQ(have_points_in_common<3>(turned, cube), gap < 0.);
  }
}
