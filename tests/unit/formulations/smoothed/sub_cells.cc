// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/sub_cells.h>

#include <gtest/gtest.h>

#include <random>

namespace
{
  using namespace tombolo;
  using dealii::GeometryInfo;
  using dealii::Point;
  using dealii::Tensor;

  /** The unit cell with corners moved by up to @p disorder. */
  template <int dim>
  typename SubCells<dim>::Corners corners_of(const double disorder, const unsigned int seed)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-disorder, disorder);
    typename SubCells<dim>::Corners corners;
    for (unsigned int k = 0; k < corners.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        corners[k][d] = GeometryInfo<dim>::unit_cell_vertex(k)[d] + shift(random);
    return corners;
  }

  template <int dim>
  void expect_closed(const typename SubCells<dim>::Corners &corners)
  {
    std::array<Tensor<1, dim>, 4> sum;
    std::array<Tensor<2, dim>, 4> moment;
    for (const auto &facet : SubCells<dim>::facets())
    {
      const Tensor<1, dim> area = SubCells<dim>::area(facet, corners);
      const Point<dim> x = SubCells<dim>::point_at(facet.centroid, corners);
      const auto add = [&](const unsigned int part, const double sign)
      {
        sum[part] += sign * area;
        moment[part] += sign * outer_product(Tensor<1, dim>(x), area);
      };
      add(facet.from, 1.);
      if (facet.to != SubCells<dim>::outside)
        add(facet.to, -1.);
    }
    for (unsigned int part = 0; part < 4; ++part)
    {
      EXPECT_LE(sum[part].norm(), 1e-15);
      const double volume = trace(moment[part]) / dim;
      EXPECT_GT(volume, 0.);
      for (unsigned int d = 0; d < dim; ++d)
        moment[part][d][d] -= volume;
      EXPECT_LE(moment[part].norm(), 1e-14);
    }
  }

  TEST(SubCells, are_closed_in_warped_cells)
  {
    EXPECT_EQ(SubCells<2>::facets().size(), 8u);
    EXPECT_EQ(SubCells<3>::facets().size(), 36u);
    for (unsigned int seed = 0; seed < 20; ++seed)
    {
      expect_closed<2>(corners_of<2>(0.2, seed));
      expect_closed<3>(corners_of<3>(0.2, seed));
    }
  }

  TEST(SubCells, of_neighbours_cut_their_common_face_alike)
  {
    // The face x = 1 of one cell is x = 0 of the next; area vectors are summed by node shares.
    const auto left = corners_of<3>(0.2, 3);
    auto right = corners_of<3>(0.2, 4);
    for (unsigned int k = 0; k < 8; k += 2)
      right[k] = left[k + 1];
    std::array<Tensor<1, 3>, 4> sums;
    for (const auto &facet : SubCells<3>::facets())
    {
      if (facet.face == 1)
        for (unsigned int k = 0; k < 4; ++k)
          sums[k] += facet.centroid[2 * k + 1] * SubCells<3>::area(facet, left);
      if (facet.face == 0)
        for (unsigned int k = 0; k < 4; ++k)
          sums[k] += facet.centroid[2 * k] * SubCells<3>::area(facet, right);
    }
    for (const Tensor<1, 3> &sum : sums)
      EXPECT_LE(sum.norm(), 1e-15);
  }

  TEST(SubCells, of_a_face_have_the_areas_of_linear_elements)
  {
    // ∫ N_k n dA of the bilinear face x = 0, by Gauss points that are exact for it.
    const auto corners = corners_of<3>(0.25, 9);
    std::array<Tensor<1, 3>, 4> exact, found;
    for (const double u : {0.5 - 0.5 / std::sqrt(3.), 0.5 + 0.5 / std::sqrt(3.)})
      for (const double v : {0.5 - 0.5 / std::sqrt(3.), 0.5 + 0.5 / std::sqrt(3.)})
      {
        const double value[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
        const double slope_u[4] = {-(1 - v), 1 - v, -v, v}, slope_v[4] = {-(1 - u), -u, 1 - u, u};
        Tensor<1, 3> a, b;
        for (unsigned int k = 0; k < 4; ++k)
        {
          a += slope_u[k] * corners[2 * k];
          b += slope_v[k] * corners[2 * k];
        }
        for (unsigned int k = 0; k < 4; ++k)
          exact[k] -= 0.25 * value[k] * cross_product_3d(a, b); // outward is -x
      }
    for (const auto &facet : SubCells<3>::facets())
      if (facet.face == 0)
        for (unsigned int k = 0; k < 4; ++k)
          found[k] += facet.centroid[2 * k] * SubCells<3>::area(facet, corners);
    for (unsigned int k = 0; k < 4; ++k)
      EXPECT_LE((found[k] - exact[k]).norm(), 1e-15);
  }

  TEST(SubCells, of_a_cube_are_equal_with_centroids_towards_their_corners)
  {
    const auto corners = corners_of<3>(0., 0);
    const double expected[4][3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
    for (unsigned int part = 0; part < 4; ++part)
    {
      const Point<3> x = SubCells<3>::point_at(SubCells<3>::centroids()[part], corners);
      for (unsigned int d = 0; d < 3; ++d)
      {
        EXPECT_GT((x[d] - 0.5) * (expected[part][d] - 0.5), 0.);
        EXPECT_NEAR(std::abs(x[d] - 0.5), std::abs(x[0] - 0.5), 1e-15);
      }
    }
  }
} // namespace
