// SPDX-License-Identifier: LGPL-2.1-or-later
// Many remaps and fine meshes, on one rank: what ranks can change is in remap.cc.
#include "remap_body.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace
{
  using namespace tombolo;
  using namespace tombolo::testing;

  constexpr unsigned int n_of_strip = 100;

  double bump(const double x)
  {
    constexpr double width = 3.;
    return std::exp(-0.5 * std::pow((x - 0.5 * n_of_strip) / width, 2));
  }

  TEST(RemapStudy, keeps_a_peak_over_400_remaps)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_field([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    body.set_points([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    for (unsigned int round = 1; round <= 400; ++round)
      body.move(body.disorder(0.25, round, true));
    body.move(body.disorder(0., 0, true));
    EXPECT_GE(body.largest_of_field(), 0.95);
    EXPECT_GE(body.largest_of_points(7), 0.75);
    EXPECT_LE(body.largest_of_field(), 1.01);
  }

  TEST(RemapStudy, by_interpolation_loses_most_of_it)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_field([](const Point<2> &x, unsigned int) { return bump(x[0]); });
    body.set_cells([](const Point<2> &x, unsigned int) { return bump(x[0]); }, body.middles());
    constexpr SmoothedIntegrationRule rule = SmoothedIntegrationRule::one_point;
    for (unsigned int round = 1; round <= 400; ++round)
      body.interpolate(body.disorder(0.25, round, true), rule);
    body.interpolate(body.disorder(0., 0, true), rule);
    RecordProperty("nodes", std::to_string(body.largest_of_field()));
    RecordProperty("points", std::to_string(body.largest_of_points(7)));
    EXPECT_LE(body.largest_of_field(), 0.5);
    EXPECT_GE(body.largest_of_field(), 0.3);
    EXPECT_LE(body.largest_of_points(7), 0.55);
    EXPECT_GE(body.largest_of_points(7), 0.35);
  }

  TEST(RemapStudy, keeps_a_peak_of_one_value_a_cell_over_400_remaps)
  {
    RemapBody<2> body({n_of_strip, 1});
    body.start(body.disorder(0., 0, true), uniform<2>);
    body.set_cells([](const Point<2> &x, unsigned int) { return bump(x[0]); }, body.middles());
    for (unsigned int round = 1; round <= 400; ++round)
      body.move_cells(body.disorder(0.25, round, true));
    body.move_cells(body.disorder(0., 0, true));
    RecordProperty("cells", std::to_string(body.largest_of_points(7)));
    EXPECT_GE(body.largest_of_points(7), 0.75);
    EXPECT_LE(body.largest_of_points(7), 1.);
  }

  struct Errors
  {
    double nodes, points, cells, interpolated;
  };

  /** The same of one value a cell. */
  double error_of_wave_in_cells(const unsigned int n, const bool by_interpolation)
  {
    RemapBody<2> body({n, 2});
    const auto wave = [n](const Point<2> &x, unsigned int)
    { return std::cos(4. * M_PI * x[0] / n); };
    body.start(body.disorder(0.2, 1), uniform<2>);
    const auto centres = [&]()
    { return by_interpolation ? body.middles() : body.centres_of_mass(); };
    body.set_cells(wave, centres());
    for (unsigned int round = 2; round < 6; ++round)
      if (by_interpolation)
        body.interpolate(body.disorder(0.2, round), SmoothedIntegrationRule::one_point);
      else
        body.move_cells(body.disorder(0.2, round));
    std::array<double, 2> sums{};
    const auto now = centres();
    for (std::size_t i = 0; i < now.size(); ++i)
    {
      sums[0] += std::pow(body.points.values[i * 8 + 7] - wave(now[i], 0), 2);
      sums[1] += 1.;
    }
    sums = ordered_sum(sums, MPI_COMM_WORLD);
    return std::sqrt(sums[0] / sums[1]);
  }

  /** Of a wave in n cells, after four remaps, in the mean square. It has no slope at the ends:
   * there the limit of points has values on one side alone, and removes the slope. */
  Errors errors_of_wave(const unsigned int n)
  {
    RemapBody<2> body({n, 2});
    const auto wave = [n](const Point<2> &x, unsigned int)
    { return std::cos(4. * M_PI * x[0] / n); };
    body.start(body.disorder(0.2, 1), uniform<2>);
    body.set_field(wave);
    body.set_points(wave);
    for (unsigned int round = 2; round < 6; ++round)
      body.move(body.disorder(0.2, round));
    std::array<double, 3> sums{};
    for (unsigned int i = 0; i < body.partition->n_owned(); ++i)
      sums[0] += std::pow(body.field.node(i)[0] - wave(body.position_of(i), 0), 2);
    const auto centres = body.point_centres();
    for (std::size_t i = 0; i < centres.size(); ++i)
    {
      sums[1] += std::pow(body.points.values[i * 8 + 7] - wave(centres[i], 0), 2);
      sums[2] += 1.;
    }
    sums = ordered_sum(sums, MPI_COMM_WORLD);
    return {std::sqrt(sums[0] / sums[2]), std::sqrt(sums[1] / sums[2]),
            error_of_wave_in_cells(n, false), error_of_wave_in_cells(n, true)};
  }

  TEST(RemapStudy, is_of_second_order)
  {
    // Over five octaves, since positions are random.
    const Errors coarse = errors_of_wave(20), fine = errors_of_wave(640);
    EXPECT_GE(std::log2(coarse.nodes / fine.nodes) / 5., 1.95);
    EXPECT_GE(std::log2(coarse.points / fine.points) / 5., 1.8);
    EXPECT_GE(std::log2(coarse.cells / fine.cells) / 5., 1.8);
    EXPECT_GE(std::log2(coarse.interpolated / fine.interpolated) / 5., 1.8);
  }
} // namespace
