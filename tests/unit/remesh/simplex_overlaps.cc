// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/remesh/cell_cutting.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/simplex_overlaps.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace
{
  using namespace tombolo;
  using namespace dealii;

  /** By pieces that are simplices. */
  template <int dim>
  OverlapMoments<dim> moments_by_pieces(const double (&points)[dim + 1][16])
  {
    SimplexOverlap::Piece<dim> piece;
    for (unsigned int k = 0; k <= dim; ++k)
      for (unsigned int j = 0; j <= dim; ++j)
        piece[k].in_new[j] = points[j][k];
    OverlapMoments<dim> result;
    SimplexOverlap::clip<dim>(piece, 0,
                              [&](const auto &piece_moments) { result.add(piece_moments); });
    return result;
  }

  template <int dim>
  double difference(const OverlapMoments<dim> &a, const OverlapMoments<dim> &b)
  {
    double result = 0;
    for (unsigned int j = 0; j < 4; ++j)
      for (unsigned int k = 0; k < 4; ++k)
        result = std::max(result, std::abs(a.products[j][k] - b.products[j][k]));
    return result;
  }

  /** Orients the first simplex to a positive volume. */
  template <int dim>
  void orient(double (&points)[dim + 1][16])
  {
    Tensor<2, dim> edges;
    for (unsigned int k = 0; k < dim; ++k)
      for (unsigned int j = 0; j < dim; ++j)
        edges[k][j] = points[j + 1][k + 1] - points[j + 1][0];
    if (determinant(edges) < 0.)
      for (auto &coordinate : points)
        std::swap(coordinate[0], coordinate[1]);
  }

  /** Old simplices whose vertices have coordinates from @p value, the sum of which is 1. Returns
   * how many have something within the new one. */
  template <int dim, typename Value>
  unsigned int expect_moments_of_pieces(const unsigned int n, const Value &value)
  {
    constexpr std::uint8_t vertices[8] = {0, 1, 2, 3, 0, 0, 0, 0};
    std::vector<OverlapMoments<dim>> expected;
    SimplexOverlaps<dim> overlaps;
    for (unsigned int round = 0; round < 2; ++round) // buffers are used again
    {
      expected.clear();
      overlaps.clear();
      for (unsigned int i = 0; i < n; ++i)
      {
        double points[dim + 1][16] = {};
        for (unsigned int k = 0; k <= dim; ++k)
        {
          points[0][k] = 1.;
          for (unsigned int j = 1; j <= dim; ++j)
          {
            points[j][k] = value();
            points[0][k] -= points[j][k];
          }
        }
        orient<dim>(points);
        overlaps.add(points, vertices);
        expected.push_back(moments_by_pieces<dim>(points));
      }
      overlaps.clip();
      std::vector<bool> is_left(n, false);
      for (const unsigned int number : overlaps.left())
      {
        OverlapMoments<dim> moments;
        overlaps.find_moments(number, moments);
        is_left[number] = true;
        EXPECT_LE(difference(moments, expected[number]), 1e-13 * (1. + expected[number].volume()));
      }
      for (unsigned int i = 0; i < n; ++i)
        EXPECT_TRUE(is_left[i] || expected[i].volume() <= 1e-14);
    }
    return static_cast<unsigned int>(std::count_if(expected.begin(), expected.end(),
                                                   [](const OverlapMoments<dim> &moments)
                                                   { return moments.volume() > 1e-12; }));
  }

  TEST(SimplexOverlaps, have_the_moments_of_pieces_that_are_simplices)
  {
    std::mt19937 numbers(1);
    std::uniform_real_distribution<double> uniform(-0.6, 1.2);
    const auto value = [&]() { return uniform(numbers); };
    EXPECT_GE(expect_moments_of_pieces<2>(2000, value), 500);
    EXPECT_GE(expect_moments_of_pieces<3>(5000, value), 1000);
  }

  TEST(SimplexOverlaps, have_them_where_vertices_lie_on_sides_but_for_round_off)
  {
    std::mt19937 numbers(2);
    const auto value = [&]()
    {
      const auto step = static_cast<int>(numbers() % 5) - 1; // -1/3 ... 1
      const auto noise = static_cast<int>(numbers() % 3) - 1;
      return step / 3. + noise * 1e-17;
    };
    EXPECT_GE(expect_moments_of_pieces<2>(2000, value), 500);
    EXPECT_GE(expect_moments_of_pieces<3>(20000, value), 2000);
  }

  TEST(ClippedTetrahedra, have_as_many_shapes_as_polyhedra_can)
  {
    const ClippedTetrahedra &shapes = ClippedTetrahedra::instance();
    EXPECT_EQ(shapes.n_shapes(), 27u);
    // Of the tetrahedron one vertex leaves another, two and three leave a prism.
    for (unsigned int inside = 1; inside < 15; ++inside)
    {
      const ClippedTetrahedra::Rest &rest = shapes.rest(ClippedTetrahedra::tetrahedron, inside);
      const int n_inside = __builtin_popcount(inside);
      EXPECT_TRUE(rest.is_possible);
      EXPECT_EQ(rest.n_vertices, n_inside == 1 ? 4 : 6);
      EXPECT_EQ(shapes.fan(rest.shape).n_triangles, n_inside == 1 ? 1u : 3u);
    }
  }

  template <int dim>
  void expect_linear_functions()
  {
    typename SubCells<dim>::Corners corners;
    for (unsigned int k = 0; k < corners.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        corners[k][d] = 100. + ((k >> d) & 1u) + 0.2 * std::sin(3. * k + d);
    const SimplexCell<dim> cell(corners);
    // Of nine cells, more than are processed together, the last one is here.
    const typename SubCells<dim>::Corners at_origin{};
    const SimplexCell<dim> elsewhere(at_origin);
    SimplexPairs<dim> pairs;
    for (unsigned int round = 0; round < 2; ++round) // lists are used again
    {
      pairs.clear_cells();
      for (unsigned int c = 0; c < 8; ++c)
        pairs.add_cell(elsewhere);
      pairs.add_cell(cell);
    }
    // A field that has the corners' numbers as values.
    double corner_values[SubCells<dim>::n_corners][node_stride] = {};
    for (unsigned int k = 0; k < SubCells<dim>::n_corners; ++k)
      corner_values[k][0] = k;
    std::vector<EightDoubles> old_values;
    values_at_points<dim>(&corner_values[0][0], 1, old_values);
    const auto &points = SimplexPoints<dim>::instance();
    double volume = 0;
    for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
    {
      unsigned int n_own = 0;
      SimplexIntegrals<dim> integrals(1), expected(1);
      pairs.start(cell, s);
      pairs.for_moments(
          [&](const typename SimplexPairs<dim>::Pair &pair, const OverlapMoments<dim> &moments)
          {
            EXPECT_EQ(pair.cell, 8u);
            volume += moments.volume() * cell.volume[s];
            integrals.add(moments, 1., pair.old_at_new, old_values,
                          points.vertices[pair.simplex].data());
            n_own += pair.simplex == s ? 1 : 0;
          });
      EXPECT_EQ(n_own, 1u);
      integrals.use_barycentric_functions();
      expected.add_whole(1., old_values, points.vertices[s].data());
      expected.use_barycentric_functions();
      for (unsigned int j = 0; j <= dim; ++j)
      {
        double sum = 0;
        for (unsigned int k = 0; k <= dim; ++k)
        {
          EXPECT_NEAR(integrals.products[j][k], (j == k ? 2. : 1.) / ((dim + 1) * (dim + 2)),
                      1e-12);
          sum +=
              (j == k ? 2. : 1.) / ((dim + 1) * (dim + 2)) * old_values[points.vertices[s][k]][0];
        }
        for (const SimplexIntegrals<dim> *const tested : {&integrals, &expected})
          EXPECT_NEAR(tested->values[j][0], sum, 1e-11);
      }
    }
    double expected = 0;
    for (const double sub_cell_volume : CellSimplices<dim>::volumes(corners))
      expected += sub_cell_volume;
    EXPECT_NEAR(volume, expected, 1e-12);
  }

  TEST(SimplexPairs, of_a_cell_with_itself_are_its_simplices)
  {
    expect_linear_functions<2>();
    expect_linear_functions<3>();
  }

  template <int dim>
  void expect_simplices_of_a_cell()
  {
    typename SubCells<dim>::Corners corners;
    for (unsigned int k = 0; k < corners.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        corners[k][d] = 1. + ((k >> d) & 1u) + 0.3 * std::sin(5. * k + d);
    const auto &all = CellSimplices<dim>::all();
    const SimplexLanes<dim> lanes(corners);
    double volumes[SimplexLanes<dim>::n_padded];
    lanes.find_volumes(volumes);
    for (std::size_t s = 0; s < all.size(); ++s)
    {
      const auto vertices = CellSimplices<dim>::vertices(all[s], corners);
      const BarycentricCoordinates<dim> coordinates(vertices);
      EXPECT_NEAR(volumes[s], CellSimplices<dim>::volume(vertices), 1e-14);
      const auto edges = lanes.edges(static_cast<unsigned int>(s / 8));
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          double cofactor[8], determinant[8];
          store_eight(edges.cofactor[k][d], cofactor);
          store_eight(edges.determinant, determinant);
          double here[dim + 1], there[dim + 1]; // they are linear
          dealii::Point<dim> point = corners.front();
          coordinates.evaluate(point, here);
          point[d] += 1.;
          coordinates.evaluate(point, there);
          EXPECT_NEAR(cofactor[s % 8] / determinant[s % 8], there[k] - here[k], 1e-12);
        }
    }
    corners.back() = corners.front(); // turns simplices over
    EXPECT_FALSE(CellSimplices<dim>::are_positive(corners));
  }

  TEST(SimplexLanes, has_the_simplices_of_a_cell)
  {
    expect_simplices_of_a_cell<2>();
    expect_simplices_of_a_cell<3>();
  }
} // namespace
