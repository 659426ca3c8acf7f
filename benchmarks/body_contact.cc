// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/mortar_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

/** Nanoseconds of processor time of contact between bodies for each pair of faces that have an area
 * in common, by the number of faces: two layers of n by n and (n - 1) by (n - 1) cells that press
 * each other. "step" is a step with pairs as they are, "search" what finding the pairs adds, in the
 * steps that do. */
namespace tombolo
{
  namespace
  {
    constexpr double gap = 1e-4, depth = 1e-4;

    /** Two layers of gmsh, format 2.2. */
    std::string mesh_text(const unsigned int n)
    {
      std::string nodes, cells;
      unsigned int n_nodes = 0, n_cells = 0;
      for (unsigned int body = 0; body < 2; ++body)
      {
        const unsigned int m = n - body, first = n_nodes + 1, row = m + 1, layer = row * row;
        for (unsigned int k = 0; k < 2; ++k)
          for (unsigned int j = 0; j <= m; ++j)
            for (unsigned int i = 0; i <= m; ++i)
            {
              const double z = (body == 0 ? k - 1. : k + n * gap) / n;
              nodes += std::to_string(++n_nodes) + " " + std::to_string(double(i) / m) + " " +
                       std::to_string(double(j) / m) + " " + std::to_string(z) + "\n";
            }
        for (unsigned int j = 0; j < m; ++j)
          for (unsigned int i = 0; i < m; ++i)
          {
            const std::string group = std::to_string(body + 1);
            cells += std::to_string(++n_cells) + " 5 2 " + group + " " + group;
            for (const unsigned int below : {0u, layer})
              for (const unsigned int corner : {0u, 1u, row + 1, row})
                cells += " " + std::to_string(first + below + j * row + i + corner);
            cells += "\n";
          }
      }
      return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"lower\"\n3 2 "
             "\"upper\"\n"
             "$EndPhysicalNames\n$Nodes\n" +
             std::to_string(n_nodes) + "\n" + nodes + "$EndNodes\n$Elements\n" +
             std::to_string(n_cells) + "\n" + cells + "$EndElements\n";
    }

    struct Bodies
    {
      explicit Bodies(const unsigned int n) : parameters(MPI_COMM_SELF)
      {
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() /
            ("tombolo_benchmark_" + std::to_string(getpid()) + ".msh");
        std::ofstream(file) << mesh_text(n);
        parameters.read_text(
            "set Dimension = 3\nset Materials = m\nset Parts = lower, upper\n"
            "set Body contacts = joint\nsubsection Mesh\nset Type = file\n"
            "subsection file\nset File = " +
                file.string() +
                "\nend\nend\n"
                "subsection Material: m\nset Model = elastic\nsubsection elastic\n"
                "set Density = 1\nset Young's modulus = 1\nset Poisson's ratio = 0\n"
                "end\nend\n"
                "subsection Part: lower\nset Cells = group lower\nset Material = m\n"
                "set Formulation = hexahedron\nend\n"
                "subsection Part: upper\nset Cells = group upper\nset Material = m\n"
                "set Formulation = hexahedron\nend\n"
                "subsection Body contact: joint\nset Slave parts = lower\n"
                "set Master parts = upper\nset Friction = 0.2\nend\n",
            "benchmark.prm");
        declare_model<3>(parameters);
        parameters.assign();
        model = std::make_unique<Model<3>>(parameters, MPI_COMM_SELF);
        std::filesystem::remove(file);
        for (const auto &process : model->processes)
        {
          if (process->observed.objects.empty())
            continue;
          contacts = process.get();
          contact = shown_by_processes<MortarContact<3>>(*model)[0];
        }
        NodalState &state = model->state;
        for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
          if (state.position.node(i)[2] > 0.5 * gap)
            state.position.node(i)[2] -= gap + depth;
        force.reinit(state.partition());
        clock.previous_step = clock.stable_step =
            model->parts[0].formulation->courant_limit(state.position).time_step;
        step = std::make_unique<MechanicalStep<3>>(*model);
        step->evaluate(clock);
      }

      Parameters parameters;
      std::unique_ptr<Model<3>> model;
      std::unique_ptr<MechanicalStep<3>> step;
      Process<3> *contacts = nullptr;
      const MortarContact<3> *contact = nullptr;
      NodalVector force;
      Clock clock;
    };

    double median(std::vector<double> values)
    {
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      return *middle;
    }

    void run(benchmark::State &state)
    {
      const auto n = static_cast<unsigned int>(state.range(0));
      Bodies bodies(n);
      const auto seconds_of_forces = [&]()
      {
        // Of this process alone: others may run beside it.
        const std::clock_t start = std::clock();
        bodies.contacts->act(*bodies.model, bodies.clock, bodies.force);
        return double(std::clock() - start) / CLOCKS_PER_SEC;
      };
      std::vector<double> step_seconds, search_seconds;
      for (auto _ : state)
      {
        bodies.contacts->model_changed(*bodies.model);
        search_seconds.push_back(seconds_of_forces());
        step_seconds.push_back(seconds_of_forces());
        state.SetIterationTime(step_seconds.back());
      }
      // Lines of n and of n - 1 cells have 2 n - 2 pieces in common.
      const double n_pairs = (2. * n - 2.) * (2. * n - 2.);
      state.counters["faces"] = n * n + (n - 1.) * (n - 1.);
      state.counters["pairs"] = n_pairs;
      state.counters["step ns/pair"] = median(step_seconds) / n_pairs * 1e9;
      state.counters["search ns/pair"] =
          (median(search_seconds) - median(step_seconds)) / n_pairs * 1e9;
      state.counters["nodes pressed"] = bodies.contact->balance().n_nodes;
    }

    BENCHMARK(run)
        ->Name("body_contact")
        ->RangeMultiplier(2)
        ->Range(8, 128)
        ->UseManualTime()
        ->Iterations(20)
        ->Unit(benchmark::kMillisecond);
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}
