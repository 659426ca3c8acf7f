// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/convex_approximation.h>
#include <tombolo/approximation/moved_convex_values.h>
#include <tombolo/state/node_partition.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace
{
  using namespace tombolo;
  using dealii::Point;
  using dealii::Tensor;

  /** Nodes at distance one, moved by up to @p disorder, @p n along each axis, from @p origin. */
  template <int dim>
  struct ConvexCloud
  {
    ConvexCloud(const unsigned int n, const double disorder, const double dilation,
                const double origin = 0.)
    {
      std::mt19937 random(17);
      std::uniform_real_distribution<double> shift(-disorder, disorder);
      for (unsigned int k = 0; k < (dim == 3 ? n : 1); ++k)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int i = 0; i < n; ++i)
          {
            const unsigned int index[3] = {i, j, k};
            for (unsigned int d = 0; d < node_stride; ++d)
            {
              position.push_back(d < dim ? origin + index[d] + shift(random) : 0.);
              support.push_back(d < dim ? dilation * (1. + 2. * disorder) : 0.);
            }
          }
    }

    unsigned int size() const
    {
      return static_cast<unsigned int>(position.size() / node_stride);
    }

    Point<dim> node(const unsigned int k) const
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = position[k * node_stride + d];
      return result;
    }

    std::vector<double> position, support;
  };

  template <int dim>
  class ConvexFunctions
  {
  public:
    explicit ConvexFunctions(const ConvexCloud<dim> &cloud)
        : approximation(make_kernel("cubic spline")), cloud(cloud), value(cloud.size()),
          gradient(cloud.size())
    {}

    typename ConvexApproximation<dim>::Result at(const Point<dim> &x)
    {
      return approximation.evaluate(x, cloud.size(), cloud.position.data(), cloud.support.data(),
                                    value.data(), gradient.data());
    }

    /** The largest error of Σ Ψ = 1 and Σ Ψ (x_J - x) = 0. */
    double consistency_error(const Point<dim> &x) const
    {
      double sum = 0;
      Tensor<1, dim> moment;
      for (unsigned int k = 0; k < cloud.size(); ++k)
      {
        sum += value[k];
        moment += value[k] * (cloud.node(k) - x);
      }
      return std::max(std::abs(sum - 1.), moment.norm());
    }

    ConvexApproximation<dim> approximation;
    const ConvexCloud<dim> &cloud;
    std::vector<double> value;
    std::vector<Tensor<1, dim>> gradient;
  };

  template <int dim>
  void expect_consistent(const double disorder, const double dilation, const double origin)
  {
    const ConvexCloud<dim> cloud(6, disorder, dilation, origin);
    ConvexFunctions<dim> functions(cloud);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> inside(1.2, 3.8);
    // Coordinates far from the origin have fewer digits behind the point.
    const double digits = std::max(1., std::abs(origin) / 10.);
    unsigned int n_iterations = 0;
    constexpr unsigned int n_points = 200;
    for (unsigned int i = 0; i < n_points; ++i)
    {
      Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = origin + inside(random);
      const auto result = functions.at(x);
      ASSERT_TRUE(result.is_inside) << x;
      n_iterations += result.n_iterations;
      EXPECT_LE(functions.consistency_error(x), 1e-12 * digits) << x;
      EXPECT_GE(*std::min_element(functions.value.begin(), functions.value.end()), 0.);
      Tensor<2, dim> position_gradient;
      Tensor<1, dim> sum;
      for (unsigned int k = 0; k < cloud.size(); ++k)
      {
        sum += functions.gradient[k];
        position_gradient += outer_product(cloud.node(k) - x, functions.gradient[k]);
      }
      EXPECT_LE(sum.norm(), 1e-11 * digits);
      for (unsigned int d = 0; d < dim; ++d)
        position_gradient[d][d] -= 1.;
      EXPECT_LE(position_gradient.norm(), 1e-11 * digits);
    }
    EXPECT_LE(n_iterations, 6 * n_points);
  }

  TEST(ConvexApproximation, is_positive_and_reproduces_linear_functions)
  {
    for (const double dilation : {1.1, 1.5, 2., 3.})
      for (const double disorder : {0., 0.3})
      {
        expect_consistent<2>(disorder, dilation, 0.);
        expect_consistent<3>(disorder, dilation, 0.);
      }
    expect_consistent<3>(0.3, 1.5, 1e4);
  }

  TEST(ConvexApproximation, has_the_gradient_of_its_values)
  {
    const ConvexCloud<3> cloud(6, 0.3, 1.5);
    ConvexFunctions<3> functions(cloud), forward(cloud), backward(cloud);
    constexpr double h = 1e-5;
    for (const Point<3> &x : {Point<3>(2.1, 2.6, 1.7), Point<3>(3.4, 1.5, 2.9)})
    {
      functions.at(x);
      for (unsigned int d = 0; d < 3; ++d)
      {
        Point<3> shifted = x;
        shifted[d] = x[d] + h;
        forward.at(shifted);
        shifted[d] = x[d] - h;
        backward.at(shifted);
        for (unsigned int k = 0; k < cloud.size(); ++k)
          EXPECT_NEAR(functions.gradient[k][d], (forward.value[k] - backward.value[k]) / (2. * h),
                      1e-7);
      }
    }
  }

  /** Where the cloud moves to, linearly and not. */
  Point<3> moved(const Point<3> &x)
  {
    return {1.2 * x[0] + 0.4 * x[1] + 0.1 * std::sin(x[2]), 0.9 * x[1] - 0.2 * x[2],
            1.1 * x[2] + 0.05 * x[0] * x[1]};
  }

  TEST(ConvexApproximation, has_the_gradient_of_its_values_where_nodes_have_moved)
  {
    const ConvexCloud<3> cloud(6, 0.3, 1.5);
    std::vector<double> present;
    for (unsigned int k = 0; k < cloud.size(); ++k)
    {
      const Point<3> x = moved(cloud.node(k));
      present.insert(present.end(), {x[0], x[1], x[2], 0.});
    }
    ConvexFunctions<3> functions(cloud), forward(cloud), backward(cloud);
    const auto evaluate =
        [&](ConvexFunctions<3> &of, const Point<3> &x, const Tensor<2, 3> &inverse)
    {
      EXPECT_TRUE(of.approximation
                      .evaluate_moved(x, cloud.size(), cloud.position.data(), cloud.support.data(),
                                      moved(x), present.data(), of.value.data(), of.gradient.data(),
                                      inverse)
                      .is_inside);
    };
    constexpr double h = 1e-5;
    const Point<3> x(2.1, 2.6, 1.7);
    Tensor<2, 3> motion;
    for (unsigned int d = 0; d < 3; ++d)
    {
      const Tensor<1, 3> change = moved(x + h * Point<3>::unit_vector(d)) - moved(x);
      const Tensor<1, 3> back = moved(x) - moved(x + -h * Point<3>::unit_vector(d));
      for (unsigned int i = 0; i < 3; ++i)
        motion[i][d] = (change[i] + back[i]) / (2. * h);
    }
    evaluate(functions, x, invert(motion));
    Tensor<1, 3> sum;
    Tensor<2, 3> position_gradient;
    for (unsigned int k = 0; k < cloud.size(); ++k)
    {
      sum += functions.gradient[k];
      position_gradient += outer_product(moved(cloud.node(k)) - moved(x), functions.gradient[k]);
    }
    EXPECT_LE(sum.norm(), 1e-11);
    for (unsigned int d = 0; d < 3; ++d)
      position_gradient[d][d] -= 1.;
    EXPECT_LE(position_gradient.norm(), 1e-11);
    for (unsigned int d = 0; d < 3; ++d)
    {
      evaluate(forward, x + h * Point<3>::unit_vector(d), invert(motion));
      evaluate(backward, x + -h * Point<3>::unit_vector(d), invert(motion));
      for (unsigned int k = 0; k < cloud.size(); ++k)
      {
        double expected = 0; // ∂Ψ/∂X = ∂Ψ/∂x ∂x/∂X
        for (unsigned int i = 0; i < 3; ++i)
          expected += functions.gradient[k][i] * motion[i][d];
        EXPECT_NEAR(expected, (forward.value[k] - backward.value[k]) / (2. * h), 1e-7);
      }
    }
  }

  TEST(ConvexApproximation, gives_barycentric_coordinates_of_a_simplex)
  {
    ConvexCloud<3> corners(0, 0., 1.);
    const double x[4][3] = {{0., 0., 0.}, {1., 0.1, 0.}, {0.2, 1.1, 0.}, {0.1, 0.3, 0.9}};
    for (const auto &corner : x)
    {
      corners.position.insert(corners.position.end(), {corner[0], corner[1], corner[2], 0.});
      corners.support.insert(corners.support.end(), {3., 3., 3., 0.});
    }
    const double share[4] = {0.1, 0.25, 0.45, 0.2};
    Point<3> inside;
    for (unsigned int k = 0; k < 4; ++k)
      inside += share[k] * corners.node(k);
    ConvexFunctions<3> functions(corners);
    ASSERT_TRUE(functions.at(inside).is_inside);
    for (unsigned int k = 0; k < 4; ++k)
      EXPECT_NEAR(functions.value[k], share[k], 1e-13);
  }

  TEST(ConvexApproximation, finds_no_functions_outside_of_the_hull)
  {
    const ConvexCloud<3> cloud(4, 0., 1.5);
    ConvexFunctions<3> functions(cloud);
    EXPECT_FALSE(functions.at(Point<3>(-0.2, 1.3, 1.4)).is_inside);
    EXPECT_FALSE(functions.at(Point<3>(-9., 1.3, 1.4)).is_inside) << "no neighbours at all";
    for (const double value : functions.value)
      EXPECT_EQ(value, 0.);
  }

  TEST(ConvexApproximation, solves_in_the_plane_of_its_neighbours)
  {
    ConvexCloud<3> plane(0, 0., 1.);
    for (unsigned int i = 0; i < 4; ++i)
      for (unsigned int j = 0; j < 4; ++j)
      {
        // A plane that is none of the axes.
        plane.position.insert(plane.position.end(), {1. * i, 1. * j, 0.5 * i - 0.25 * j, 0.});
        plane.support.insert(plane.support.end(), {1.5, 1.5, 1.5, 0.});
      }
    ConvexFunctions<3> functions(plane);
    const Point<3> x(1.3, 1.6, 0.5 * 1.3 - 0.25 * 1.6);
    ASSERT_TRUE(functions.at(x).is_inside);
    EXPECT_LE(functions.consistency_error(x), 1e-12);
  }

  /** Σ Ψ of the nodes that are not on the face x = 0, at the distance @p delta from it. */
  double sum_off_face(const double delta)
  {
    const ConvexCloud<3> cloud(5, 0., 1.1);
    ConvexFunctions<3> functions(cloud);
    EXPECT_TRUE(functions.at(Point<3>(delta, 2.3, 1.6)).is_inside);
    double sum = 0;
    for (unsigned int k = 0; k < cloud.size(); ++k)
      if (cloud.node(k)[0] > 0.5)
        sum += functions.value[k];
    return sum;
  }

  TEST(ConvexApproximation, interpolates_on_convex_faces_in_the_limit)
  {
    for (const double delta : {1e-1, 1e-3, 1e-5})
      EXPECT_LE(sum_off_face(delta), 1.5 * delta);
  }

  TEST(ConvexApproximation, has_the_same_values_at_many_moved_places_at_a_time)
  {
    const ConvexCloud<3> cloud(6, 0.3, 1.5);
    std::vector<double> present;
    for (unsigned int k = 0; k < cloud.size(); ++k)
    {
      const Point<3> x = moved(cloud.node(k));
      present.insert(present.end(), {x[0], x[1], x[2], 0.});
    }
    ConvexFunctions<3> functions(cloud);
    MovedConvexValues<3> together(make_kernel("cubic spline"));
    together.set_neighbours(cloud.size(), cloud.position.data(), cloud.support.data(),
                            present.data());
    constexpr unsigned int n = 5;
    MovedConvexValues<3>::Points x, present_x;
    for (unsigned int index = 0; index < n; ++index)
    {
      x[index] = Point<3>(1.6 + 0.4 * index, 2.9 - 0.3 * index, 2.1 + 0.2 * index);
      present_x[index] = moved(x[index]);
    }
    x[n - 1] = Point<3>(-1., 2., 2.); // the hull does not have it
    present_x[n - 1] = moved(x[n - 1]);
    EXPECT_EQ(together.evaluate(n, x, present_x), (1u << (n - 1)) - 1);
    for (unsigned int index = 0; index + 1 < n; ++index)
    {
      EXPECT_TRUE(functions.approximation
                      .evaluate_moved(x[index], cloud.size(), cloud.position.data(),
                                      cloud.support.data(), present_x[index], present.data(),
                                      functions.value.data())
                      .is_inside);
      std::vector<double> values(cloud.size(), 0.);
      for (unsigned int k = 0; k < together.n_values(index); ++k)
        values[together.neighbour(index, k)] = together.value(index, k);
      for (unsigned int k = 0; k < cloud.size(); ++k)
        EXPECT_NEAR(values[k], functions.value[k], 1e-12);
    }
  }
} // namespace
