// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 3
#include <tombolo/base/ordered_sum.h>
#include <tombolo/remesh/inner_positions.h>

#include "dimensions.h"
#include "plugin_interpolated_remap/cloud_interpolation.h"
#include "remap_body.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;
  using namespace dealii;

  template <typename>
  class RemapOfDimension : public ::testing::Test
  {};
  TYPED_TEST_SUITE(RemapOfDimension, Dimensions);

  template <int dim>
  void expect_no_bit_of_an_identity(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    const auto motion = body.disorder(0.25, 1);
    body.start(motion, uniform<dim>);
    body.set_field(rough<dim>);
    body.set_points(rough<dim>);
    const PointValues before = body.points;
    NodalVector field = body.field.copy();
    if (by_interpolation)
      body.interpolate(motion);
    else
      body.move(motion);
    EXPECT_EQ(before.values, body.points.values);
    EXPECT_EQ(before.mass, body.points.mass);
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        EXPECT_EQ(field.node(i)[slot], body.field.node(i)[slot]);
  }

  TEST(Remap, changes_no_bit_where_nothing_moves)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_no_bit_of_an_identity<2>(by_interpolation);
      expect_no_bit_of_an_identity<3>(by_interpolation);
    }
  }

  template <int dim>
  void expect_linear_nodal_fields(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    body.set_field(linear<dim>);
    for (unsigned int round = 2; round < 5; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.2, round));
      else
        body.move(body.disorder(0.2, round));
    double error = 0;
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        error =
            std::max(error, std::abs(body.field.node(i)[slot] - linear(body.position_of(i), slot)));
    EXPECT_LE(body.largest([&] { return error; }), 1e-12);
  }

  TEST(Remap, reproduces_linear_nodal_fields)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_linear_nodal_fields<2>(by_interpolation);
      expect_linear_nodal_fields<3>(by_interpolation);
    }
  }

  TYPED_TEST(RemapOfDimension, by_interpolation_reproduces_linear_fields_of_points)
  {
    constexpr int dim = TypeParam::value;
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    const auto shares = corner_shares_of_points<dim>(SmoothedIntegrationRule::smoothed);
    const auto point_positions = [&]()
    {
      std::vector<Point<dim>> result;
      for (const auto &nodes : body.nodes_of_cells())
        for (const auto &corner_weights : shares)
        {
          Point<dim> x;
          for (unsigned int k = 0; k < nodes.size(); ++k)
            x += corner_weights[k] * body.position_of(nodes[k]);
          result.push_back(x);
        }
      return result;
    };
    const auto before = point_positions();
    for (std::size_t i = 0; i < before.size(); ++i)
      for (unsigned int f = 0; f < 8; ++f)
        body.points.values[i * 8 + f] = linear(before[i], f);
    body.points.stress.reset(); // its bound is not that of linear fields
    body.interpolate(body.disorder(0.2, 2));
    double error = 0;
    const auto after = point_positions();
    const double top = block<dim>()[0];
    for (std::size_t i = 0; i < after.size(); ++i)
    {
      bool is_inside = true; // of the hull of the points
      for (unsigned int d = 0; d < dim; ++d)
        is_inside = is_inside && after[i][d] > 1. && after[i][d] < top - 1.;
      for (unsigned int f = 0; f < 8 && is_inside; ++f)
        error = std::max(error, std::abs(body.points.values[i * 8 + f] - linear(after[i], f)));
    }
    // What the bound of the multiplier costs at the outermost points decays inwards.
    EXPECT_LE(body.largest([&] { return error; }), 1e-5);
  }

  TYPED_TEST(RemapOfDimension, keeps_mass_momentum_and_sums_of_points_and_all_bounds)
  {
    constexpr int dim = TypeParam::value;
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.25, 1), [](const Point<dim> &x) { return 1. + 0.3 * x[0]; });
    body.set_field(rough<dim>);
    body.set_points(rough<dim>);
    const std::vector<double> before = body.sums();
    std::vector<double> highest, lowest;
    for (unsigned int f = 0; f < 8; ++f)
    {
      highest.push_back(body.largest_of_points(f));
      lowest.push_back(body.largest_of_points(f, -1.));
    }
    for (unsigned int round = 2; round < 5; ++round)
      body.move(body.disorder(0.25, round));
    const std::vector<double> after = body.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    for (unsigned int f = 0; f < 8; ++f)
    {
      EXPECT_LE(body.largest_of_points(f), highest[f] + 1e-14);
      EXPECT_LE(body.largest_of_points(f, -1.), lowest[f] + 1e-14);
    }
    EXPECT_LE(body.largest_of_points(6, -1.), 0.); // not negative
  }

  TYPED_TEST(RemapOfDimension, keeps_nodal_fields_within_bounds_that_a_projection_leaves)
  {
    constexpr int dim = TypeParam::value;
    const double middle = 0.5 * block<dim>()[0];
    const auto step = [middle](const Point<dim> &x, const unsigned int slot)
    { return slot == 3 ? x[0] : (x[0] < middle ? 1. : 0.); };
    RemapBody<dim> limited(block<dim>()), plain(block<dim>());
    for (RemapBody<dim> *const body : {&limited, &plain})
    {
      body->start(body->disorder(0.2, 1), [](const Point<dim> &) { return 1.5; });
      body->set_field(step);
      body->set_points(rough<dim>);
    }
    const std::vector<double> before = limited.sums();
    for (unsigned int round = 2; round < 7; ++round)
    {
      limited.move_within_bounds(limited.disorder(0.2, round));
      plain.move(plain.disorder(0.2, round));
      EXPECT_LE(limited.largest_of_field(), 1. + 1e-12);
      EXPECT_GT(plain.largest_of_field(), 1.01);
    }
    const std::vector<double> after = limited.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    double error = 0, lowest = 0;
    for (unsigned int i = 0; i < limited.partition->n_owned(); ++i)
    {
      error = std::max(error, std::abs(limited.field.node(i)[3] - limited.position_of(i)[0]));
      lowest = std::min(lowest, limited.field.node(i)[0]);
    }
    EXPECT_LE(limited.largest([&] { return error; }), 1e-12);
    EXPECT_LE(limited.largest([&] { return -lowest; }), 1e-12);
  }

  /** The disorder, and a surface that is raised and lowered by up to a tenth of the spacing. */
  template <int dim>
  typename RemapBody<dim>::Motion waves(const RemapBody<dim> &body, const unsigned int round)
  {
    const auto inside = body.disorder(0.2, round);
    const double top = block<dim>()[0];
    return [=](const Point<dim> &x)
    {
      Point<dim> result = inside(x);
      const double wave = 0.1 * std::sin(1.7 * x[0] + round) * std::cos(0.9 * x[dim - 1] + round);
      result[1] += x[1] > top - 0.5 ? wave : 0.;
      return result;
    };
  }

  TYPED_TEST(RemapOfDimension, keeps_sums_constant_fields_and_bounds_where_the_surface_moves)
  {
    constexpr int dim = TypeParam::value;
    RemapBody<dim> body(block<dim>());
    body.start(waves(body, 1), [](const Point<dim> &x) { return 1. + 0.3 * x[0]; });
    body.set_field([](const Point<dim> &x, const unsigned int slot)
                   { return slot == 3 ? 2.5 : rough(x, slot); });
    body.set_points(rough<dim>);
    const std::vector<double> before = body.sums();
    std::vector<double> highest;
    for (unsigned int f = 0; f < 8; ++f)
      highest.push_back(body.largest_of_points(f));
    for (unsigned int round = 2; round < 7; ++round)
      body.move_surface(waves(body, round));
    const std::vector<double> after = body.sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[0]) << "sum " << k << " in " << dim;
    for (unsigned int f = 0; f < 8; ++f)
      EXPECT_LE(body.largest_of_points(f), highest[f] + 1e-14);
    double error = 0;
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      error = std::max(error, std::abs(body.field.node(i)[3] - 2.5));
    EXPECT_LE(body.largest([&] { return error; }), 1e-12);
  }

  /** A cavity in the top of a block, four fifths deep. */
  template <int dim>
  typename RemapBody<dim>::Motion cavity()
  {
    const double top = block<dim>()[0];
    return [=](const Point<dim> &x)
    {
      double depth = 0.8;
      for (unsigned int d = 0; d < dim; ++d)
        if (d != 1)
          depth *= std::pow(std::sin(numbers::PI * x[d] / top), 4);
      Point<dim> result = x;
      result[1] *= 1. - depth;
      return result;
    };
  }

  template <int dim>
  void expect_cells_below_a_cavity()
  {
    RemapBody<dim> body(block<dim>());
    body.start(cavity<dim>(), uniform<dim>);
    const NodalVector inside = body.inner_nodes();
    const double at_start = body.smallest_volume();
    double first = 0, last = 0;
    for (unsigned int step = 0; step < 30; ++step)
    {
      const NodalVector way = winslow_step<dim>(body.nodes_of_cells(), body.lattice_corners(),
                                                inside, body.lattice, body.position);
      double largest = 0;
      for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          EXPECT_TRUE(*inside.node(i) > 0. || way.node(i)[d] == 0.);
          body.position.node(i)[d] += way.node(i)[d];
          largest = std::max(largest, std::abs(way.node(i)[d]));
        }
      body.position.update_ghosts();
      last = Utilities::MPI::max(largest, MPI_COMM_WORLD);
      first = step == 0 ? last : first;
      EXPECT_GT(body.smallest_volume(), 0.) << "step " << step << " in " << dim;
    }
    EXPECT_LE(last, 1e-3 * first);
    EXPECT_GT(at_start, 0.);
    // Displacements that are harmonic fold them.
    place_inner_nodes<dim>(body.nodes_of_cells(), body.lattice_corners(), inside, body.lattice,
                           body.position);
    EXPECT_LT(body.smallest_volume(), 0.);
  }

  TEST(InnerPlaces, do_not_fold_below_a_cavity)
  {
    expect_cells_below_a_cavity<2>();
    expect_cells_below_a_cavity<3>();
  }

  double mises(const double *s)
  {
    return std::sqrt(
        0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
        3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
  }

  template <int dim>
  void expect_stress_within_the_yield_surface(const bool by_interpolation)
  {
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.25, 1), uniform<dim>);
    body.set_points(rough<dim>);
    const auto largest = [&]()
    {
      double result = 0;
      for (std::size_t i = 0; i < body.points.mass.size(); ++i)
        result = std::max(result, mises(body.points.values.data() + i * 8));
      return Utilities::MPI::max(result, MPI_COMM_WORLD);
    };
    for (std::size_t i = 0; i < body.points.mass.size(); ++i)
    {
      double *const stress = body.points.values.data() + i * 8;
      const double factor = 1. / mises(stress);
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] *= factor;
    }
    for (unsigned int round = 2; round < 5; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.25, round));
      else
        body.move(body.disorder(0.25, round));
    EXPECT_LE(largest(), 1. + 1e-12);
    EXPECT_GT(largest(), 0.5);
    EXPECT_LE(body.largest_of_points(6, -1.), 0.); // not negative
  }

  TEST(Remap, leaves_stress_within_a_yield_surface_that_all_points_are_on)
  {
    for (const bool by_interpolation : {false, true})
    {
      expect_stress_within_the_yield_surface<2>(by_interpolation);
      expect_stress_within_the_yield_surface<3>(by_interpolation);
    }
  }

  TEST(CloudInterpolation, of_a_step_has_lobes_that_its_limit_cuts)
  {
    Cloud<2> cloud, targets;
    std::vector<double> values;
    const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
    for (unsigned int i = 0; i < 12 && rank == 0; ++i)
      for (unsigned int j = 0; j < 12; ++j)
      {
        cloud.positions.emplace_back(i + 0.2 * std::sin(3. * i + j),
                                     j + 0.2 * std::cos(i + 2. * j));
        cloud.bodies.push_back(0.);
        Tensor<2, 2> metric;
        metric[0][0] = metric[1][1] = 1. / 1.5;
        cloud.metrics.push_back(metric);
        values.push_back(i < 6 ? 0. : 1.);
        targets.positions.emplace_back(i - 0.5, j + 0.3);
        targets.bodies.push_back(0.);
      }
    const CloudInterpolation<2> interpolation(cloud, targets, MPI_COMM_WORLD);
    std::vector<double> found = interpolation.interpolate(values, 1);
    if (rank == 0)
    {
      EXPECT_LT(*std::min_element(found.begin(), found.end()), -1e-3);
      EXPECT_GT(*std::max_element(found.begin(), found.end()), 1.001);
    }
    interpolation.limit(values, 1, {}, found);
    for (const double value : found)
    {
      EXPECT_GE(value, 0.);
      EXPECT_LE(value, 1.);
    }
  }

  TYPED_TEST(RemapOfDimension, keeps_sums_and_bounds_of_one_value_a_cell)
  {
    constexpr int dim = TypeParam::value;
    RemapBody<dim> body(block<dim>());
    body.start(body.disorder(0.2, 1), uniform<dim>);
    body.set_cells(rough<dim>, body.middles());
    const auto sums = [&]()
    {
      std::vector<double> result(9, 0.);
      for (std::size_t c = 0; c < body.points.mass.size(); ++c)
      {
        result[8] += body.points.mass[c];
        for (unsigned int f = 0; f < 8; ++f)
          result[f] += body.points.mass[c] * body.points.values[c * 8 + f];
      }
      return ordered_sum(result, MPI_COMM_WORLD);
    };
    const std::vector<double> before = sums();
    const double highest = body.largest_of_points(6), lowest = -body.largest_of_points(6, -1.);
    for (unsigned int round = 2; round < 5; ++round)
      body.move_cells(body.disorder(0.2, round));
    const std::vector<double> after = sums();
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_NEAR(before[k], after[k], 1e-13 * before[8]) << "sum " << k << " in " << dim;
    EXPECT_LE(body.largest_of_points(6), highest + 1e-14);
    EXPECT_GE(-body.largest_of_points(6, -1.), lowest - 1e-14);
  }

  TEST(CloudFunctions, exist_at_every_place_and_depend_continuously_on_it)
  {
    CloudFunctions<2> functions;
    std::vector<Point<2>> points;
    std::vector<Tensor<2, 2>> metrics;
    for (unsigned int i = 0; i < 4; ++i)
      for (unsigned int j = 0; j < 4; ++j)
      {
        points.emplace_back(i + 0.1 * std::sin(3. * i + j), j + 0.1 * std::cos(i + 2. * j));
        Tensor<2, 2> metric;
        metric[0][0] = metric[1][1] = 1. / 1.3;
        metrics.push_back(metric);
      }
    std::vector<double> values;
    const auto found = [&](const Point<2> &x)
    {
      EXPECT_TRUE(functions.evaluate(x, points, metrics, values));
      Point<2> reproduced;
      double sum = 0;
      for (std::size_t j = 0; j < points.size(); ++j)
      {
        EXPECT_GE(values[j], 0.);
        sum += values[j];
        reproduced += values[j] * points[j];
      }
      EXPECT_NEAR(sum, 1., 1e-14);
      return reproduced;
    };
    EXPECT_LE(found(Point<2>(1.4, 1.7)).distance(Point<2>(1.4, 1.7)), 1e-13);
    // A point on the hull; a point outside of a face; and one nearby.
    EXPECT_LE(found(points[0]).distance(points[0]), 1e-12);
    const Point<2> outside(1.3, -0.8), near(1.3 + 1e-9, -0.8);
    const Point<2> reproduced = found(outside);
    EXPECT_LE(found(near).distance(reproduced), 1e-7);
    EXPECT_LE(reproduced[1], 0.25);
    EXPECT_FALSE(functions.evaluate(Point<2>(9., 9.), points, metrics, values));
  }

  /** Two walls have passed each other in the middle, where cells were void, and all is one body
   * then but for its last cells, which are emptied; sums before and after, and bounds. */
  template <int dim>
  void expect_joined_walls(const std::vector<unsigned int> &n)
  {
    const double length = n[0];
    RemapBody<dim> body(n);
    // Full cells are as far as 3 from the ends in the lattice, and reach over the middle now.
    const auto was_void = [&](const Point<dim> &x) { return x[0] > 3. && x[0] < length - 3.; };
    const auto is_void = [&](const Point<dim> &x) { return x[0] > length - 1.; };
    const auto disorder = body.disorder(0.1, 1);
    const auto walls = [&](const Point<dim> &x)
    {
      Point<dim> result = disorder(x);
      const double reach = (0.5 * length + 0.1) / 3.;
      if (x[0] < 3.5)
        result[0] *= reach;
      else if (x[0] > length - 3.5)
        result[0] = length - (length - result[0]) * reach;
      return result;
    };
    body.start(walls, [](const Point<dim> &x) { return 1. + 0.1 * x[0]; });
    body.empty(was_void);
    body.set_field([&](const Point<dim> &x, unsigned int slot)
                   { return x[0] < 0.5 * length ? 1. + slot : -2.; });
    body.set_points([](const Point<dim> &x, unsigned int f) { return std::sin(x[0] + f); });
    const std::vector<double> before = body.sums();
    body.fill(body.disorder(0.2, 2), was_void, is_void);
    const std::vector<double> after = body.sums();
    for (unsigned int k = 0; k < before.size(); ++k)
      EXPECT_NEAR(after[k], before[k], 1e-12 * std::abs(before[0])) << k;
    const auto middle = body.middles_of_lattice();
    for (std::size_t c = 0; c < middle.size(); ++c)
      for (unsigned int q = 0; q < SubCells<dim>::n_sub_cells; ++q)
      {
        const std::size_t i = c * SubCells<dim>::n_sub_cells + q;
        EXPECT_EQ(body.points.mass[i] > 0., !is_void(middle[c])) << middle[c];
        for (unsigned int f = 0; f < 8 && !is_void(middle[c]); ++f)
          EXPECT_LE(std::abs(body.points.values[i * 8 + f]), 1. + 1e-12);
      }
    // Nodes of emptied cells alone keep nothing.
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      if (body.lattice.node(i)[0] > length - 0.5)
      {
        EXPECT_EQ(body.field.node(i)[0], 0.);
      }
  }

  TEST(Remap, of_walls_that_meet_keeps_sums_in_filled_cells)
  {
    expect_joined_walls<2>({8, 5});
    expect_joined_walls<3>({8, 3, 3});
  }
} // namespace
