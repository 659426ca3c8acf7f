// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/approximation/radial_rows.h>

#include "../tests/particle_clouds.h"

#include <benchmark/benchmark.h>

namespace
{
  using namespace tombolo;

  constexpr unsigned int n_along_axis = 46; // 97,336 particles

  Stencils rows_of(const ParticleCloud &cloud, const double skin)
  {
    Stencils shape;
    shape.particle_node = cloud.nodes;
    NeighbourSearch<3> search;
    search.find(cloud.nodes, cloud.nodes, cloud.position.data(), cloud.support.data(), skin,
                shape.row_start, shape.neighbour);
    return shape;
  }

  void report(benchmark::State &state, const Stencils &shape)
  {
    const double n = shape.n_particles();
    state.counters["neighbours"] = double(shape.row_start.back()) / n;
    state.counters["ns/particle"] = benchmark::Counter(
        n * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }

  /** Disorder in percent, skin in percent. */
  void neighbour_search(benchmark::State &state)
  {
    const ParticleCloud cloud = lattice_cloud<3>(n_along_axis, 1.8, 0.01 * double(state.range(0)));
    const double skin = 0.01 * double(state.range(1));
    Stencils shape = rows_of(cloud, skin);
    NeighbourSearch<3> search;
    for (auto _ : state)
      search.find(cloud.nodes, cloud.nodes, cloud.position.data(), cloud.support.data(), skin,
                  shape.row_start, shape.neighbour);
    report(state, shape);
  }

  void moving_least_squares(benchmark::State &state, const char *kernel)
  {
    const ParticleCloud cloud = lattice_cloud<3>(n_along_axis, 1.8, 0.01 * double(state.range(0)));
    Stencils shape = rows_of(cloud, 0.01 * double(state.range(1)));
    MovingLeastSquares<3> mls(make_kernel(kernel));
    for (auto _ : state)
      mls.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), shape);
    report(state, shape);
  }

  /** Disorder in percent; corrected rows of a smoothing length of 1.2 spacings, among them the
   * candidates within a tenth of the support more. */
  void radial_rows(benchmark::State &state)
  {
    constexpr double smoothing_length = 1.2;
    ParticleCloud cloud =
        lattice_cloud<3>(n_along_axis, 2. * smoothing_length, 0.01 * double(state.range(0)));
    for (const unsigned int node : cloud.nodes)
      cloud.support[node * node_stride + RadialRows<3>::volume_slot] = 1.;
    const Stencils candidates = rows_of(cloud, 0.1);
    Stencils shape;
    RadialRows<3> rows(RadialKernel<3>(make_kernel("hyperbolic spline"), smoothing_length), true,
                       0.5, RadialRows<3>::Uncorrected::raw);
    for (auto _ : state)
      rows.compute(cloud.nodes, cloud.position.data(), cloud.support.data(), {}, candidates, shape);
    report(state, shape);
  }

  BENCHMARK(radial_rows)->Arg(0)->Arg(20);
  BENCHMARK(neighbour_search)->Args({0, 0})->Args({0, 10})->Args({20, 0})->Args({20, 10});
  BENCHMARK_CAPTURE(moving_least_squares, cubic, "cubic spline")
      ->Args({0, 0})
      ->Args({20, 0})
      ->Args({20, 10});
  BENCHMARK_CAPTURE(moving_least_squares, quintic, "quintic spline")->Args({0, 0});
} // namespace

BENCHMARK_MAIN();
