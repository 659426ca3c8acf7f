// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

// What the machine can do, to stand beside what the program does: memory bandwidth and peak rate.
// On several ranks all measure at the same time, and the sum is reported.
namespace
{
  using namespace dealii;
  using namespace tombolo;

  // 128 MiB an array: beyond every cache of the machines of today.
  constexpr std::size_t triad_size = std::size_t(1) << 24;

  // Enough independent chains to hide the latency of a fused multiply-add at two per cycle.
  constexpr unsigned int n_chains = 10;
  constexpr unsigned int n_repetitions = 1000000;

  /** Starts on all ranks together and returns the time of the slowest. The number of
   * iterations must be fixed, so that all ranks take part in each. */
  template <typename Work>
  void time_on_all_ranks(benchmark::State &state, const Work &work)
  {
    for (auto _ : state)
    {
      MPI_Barrier(MPI_COMM_WORLD);
      const double start = MPI_Wtime();
      work();
      state.SetIterationTime(Utilities::MPI::max(MPI_Wtime() - start, MPI_COMM_WORLD));
    }
  }

  /** The sum over ranks, per second. */
  benchmark::Counter rate(const double amount_per_rank)
  {
    return benchmark::Counter(amount_per_rank * Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD),
                              benchmark::Counter::kIsIterationInvariantRate);
  }

  /** a = b + s c. Two arrays are read and one is written; that writing fetches the line first is
   * not counted, as in the STREAM benchmark. */
  void memory_bandwidth(benchmark::State &state)
  {
    std::vector<double> a(triad_size, 0.), b(triad_size, 1.), c(triad_size, 2.);
    time_on_all_ranks(state,
                      [&]
                      {
                        for (std::size_t i = 0; i < triad_size; ++i)
                          a[i] = b[i] + 3. * c[i];
                        benchmark::DoNotOptimize(a.data());
                        benchmark::ClobberMemory();
                      });
    state.counters["bytes_per_second"] = rate(3. * sizeof(double) * triad_size);
  }

  template <std::size_t... chain>
  void multiply_add(std::array<Lanes, n_chains> &values, const Lanes &factor,
                    const Lanes &increment, std::index_sequence<chain...>)
  {
    ((values[chain] = values[chain] * factor + increment), ...);
  }

  /** Chains of x = x f + g on Lanes. */
  void peak_rate(benchmark::State &state)
  {
    // The values converge to 2 and stay normal numbers.
    Lanes factor = 0.5, increment = 1.;
    benchmark::DoNotOptimize(factor);
    benchmark::DoNotOptimize(increment);
    time_on_all_ranks(state,
                      [&]
                      {
                        std::array<Lanes, n_chains> values;
                        values.fill(increment);
                        for (unsigned int i = 0; i < n_repetitions; ++i)
                          multiply_add(values, factor, increment,
                                       std::make_index_sequence<n_chains>());
                        benchmark::DoNotOptimize(values);
                      });
    state.counters["flops_per_second"] = rate(2. * n_lanes * n_chains * n_repetitions);
  }

  BENCHMARK(memory_bandwidth)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(50);
  BENCHMARK(peak_rate)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(50);

  class SilentReporter : public benchmark::BenchmarkReporter
  {
  public:
    bool ReportContext(const Context & /*context*/) override
    {
      return true;
    }
    void ReportRuns(const std::vector<Run> & /*runs*/) override {}
  };
} // namespace

int main(int argc, char **argv)
{
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool is_first_rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  std::vector<char *> arguments;
  for (int i = 0; i < argc; ++i)
    // One rank writes the file.
    if (is_first_rank || std::string(argv[i]).rfind("--benchmark_out", 0) != 0)
      arguments.push_back(argv[i]);
  int n_arguments = static_cast<int>(arguments.size());
  benchmark::Initialize(&n_arguments, arguments.data());
  if (is_first_rank)
    benchmark::RunSpecifiedBenchmarks();
  else
  {
    SilentReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
  }
}
