// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/contact_surface.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

/** Nanoseconds per surface node to find its gap to a tool, by the number of triangles and of nodes:
 * a block of nodes below a sphere, as a surface of triangles and as an exact one. "far": no node is
 * in the box around the tool; "near": all are, a part in contact; "rounded": near, with an edge
 * radius, so that nodes in contact search for the centre of a ball. */
namespace tombolo
{
  namespace
  {
    constexpr double sphere_radius = 1.;

    /** A sphere of 4 n^2 triangles, less two rings at its poles. */
    std::string sphere_text(const unsigned int n)
    {
      std::string text = "v 0 0 -1\nv 0 0 1\n";
      char line[100];
      for (unsigned int i = 1; i < n; ++i)
        for (unsigned int j = 0; j < 2 * n; ++j)
        {
          const double theta = dealii::numbers::PI * i / n, phi = dealii::numbers::PI * j / n;
          std::snprintf(line, sizeof(line), "v %.17g %.17g %.17g\n",
                        std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                        -std::cos(theta));
          text += line;
        }
      const auto vertex = [&](const unsigned int i, const unsigned int j) {
        return i == 0 ? 1 : i == n ? 2 : 3 + (i - 1) * 2 * n + j % (2 * n);
      };
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < 2 * n; ++j)
        {
          if (i > 0)
            text += "f " + std::to_string(vertex(i, j)) + " " + std::to_string(vertex(i, j + 1)) +
                    " " + std::to_string(vertex(i + 1, j)) + "\n";
          if (i + 1 < n)
            text += "f " + std::to_string(vertex(i, j + 1)) + " " +
                    std::to_string(vertex(i + 1, j + 1)) + " " + std::to_string(vertex(i + 1, j)) +
                    "\n";
        }
      return text;
    }

    struct Tool
    {
      Tool(const std::string &name, const std::string &entries) : parameters(MPI_COMM_SELF)
      {
        parameters.read_text("subsection " + name + "\n" + entries +
                                 "set Origin = 0, 0, 0\nset Angle = 3*t\nend\n",
                             "benchmark.prm");
        Registry<ContactSurface<3>>::instance().declare_all(parameters.handler());
        parameters.assign();
        surface = Registry<ContactSurface<3>>::instance().create(name, parameters.section(name));
        surface->load(MPI_COMM_SELF);
      }

      Parameters parameters;
      std::unique_ptr<ContactSurface<3>> surface;
    };

    std::unique_ptr<Tool> make_tool(const unsigned int n, const double edge_radius)
    {
      if (n == 0)
        return std::make_unique<Tool>("sphere", "set Radius = 1\n");
      const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                         ("tombolo_benchmark_" + std::to_string(getpid()) + ".obj");
      std::ofstream(file) << sphere_text(n);
      auto tool = std::make_unique<Tool>(
          "triangles", "set File = " + file.string() +
                           "\nset Edge radius = " + std::to_string(edge_radius) + "\n");
      std::filesystem::remove(file);
      return tool;
    }

    /** Nodes of the upper side of a block, of the width of the sphere, at the height @p top. */
    struct Nodes
    {
      Nodes(const unsigned int n_along, const double top)
      {
        const unsigned int n = n_along * n_along;
        position.reinit(std::make_shared<const NodePartition>(dealii::complete_index_set(n),
                                                              dealii::IndexSet(n), MPI_COMM_SELF));
        for (unsigned int i = 0; i < n; ++i)
        {
          numbers.push_back(i);
          position.node(i)[0] = sphere_radius * (1.99 * (i % n_along) / n_along - 0.99);
          position.node(i)[1] = sphere_radius * (1.99 * (i / n_along) / n_along - 0.99);
          position.node(i)[2] = top;
        }
      }

      NodalVector position;
      std::vector<unsigned int> numbers;
    };

    void run(benchmark::State &state, const unsigned int n_around, const unsigned int n_along,
             const double top, const double edge_radius)
    {
      const auto tool = make_tool(n_around, edge_radius);
      const Nodes nodes(n_along, top);
      std::vector<double> gap;
      std::vector<double> seconds;
      for (auto _ : state)
      {
        const auto start = std::chrono::steady_clock::now();
        tool->surface->evaluate_gaps(nodes.position, nodes.numbers, 0.1, gap);
        seconds.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        state.SetIterationTime(seconds.back());
      }
      // The median leaves out what other processes used.
      const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
      std::nth_element(seconds.begin(), middle, seconds.end());
      const auto n = static_cast<double>(nodes.numbers.size());
      state.counters["ns/node"] = *middle / n * 1e9;
      state.counters["triangles"] = 4. * n_around * (n_around > 0 ? n_around - 1. : 0.);
      state.counters["nodes"] = n;
      state.counters["in contact"] = static_cast<double>(
          std::count_if(gap.begin(), gap.end(), [](double g) { return g < 0.; }));
    }

    void add(const std::string &name, const unsigned int n_around, const unsigned int n_along,
             const double top, const double edge_radius = 0.)
    {
      benchmark::RegisterBenchmark(
          (name + "/" + std::to_string(n_around) + "/" + std::to_string(n_along)).c_str(),
          [=](benchmark::State &state) { run(state, n_around, n_along, top, edge_radius); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  using namespace tombolo;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  // Triangles by four from one line to the next, at 10,000 nodes; then nodes, at 16,000 triangles.
  for (const unsigned int n_around : {0u, 8u, 16u, 32u, 64u, 128u, 256u})
  {
    add("far", n_around, 100, -1.5);
    add("near", n_around, 100, -0.95);
    if (n_around > 0)
      add("rounded", n_around, 100, -0.95, 0.1);
  }
  for (const unsigned int n_along : {32u, 316u, 1000u})
    add("near", 64, n_along, -0.95);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}
