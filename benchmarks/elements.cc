// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_generator.h>

#include <benchmark/benchmark.h>

#include <tombolo/formulations/formulation.h>
#include <tombolo/materials/linear_elastic.h>

#include <cmath>
#include <functional>
#include <memory>

/** Nanoseconds per cell and step of each element, elastic, about 10⁵ cells (of higher degree: as
 * many nodes), on one core: `force` is the formulation alone, `step` is a whole explicit step with
 * the update of the nodes. */
namespace tombolo
{
  namespace
  {
    struct Model
    {
      Model(const std::string &element, const std::string &entries, const unsigned int n_cells)
          : mesh(MPI_COMM_SELF)
      {
        Parameters parameters(MPI_COMM_SELF);
        parameters.read_text("subsection formulation\nsubsection " + element + "\n" + entries +
                                 "\nend\nend\nsubsection elastic\nset Density = 7800\n"
                                 "set Young's modulus = 200e9\nset Poisson's ratio = 0.3\nend\n",
                             "benchmark.prm");
        auto &registry = Registry<Formulation<3>>::instance();
        parameters.handler().enter_subsection("formulation");
        registry.declare_all(parameters.handler());
        parameters.handler().leave_subsection();
        parameters.handler().enter_subsection("elastic");
        declare<LinearElastic>(parameters.handler());
        parameters.handler().leave_subsection();
        parameters.assign();
        material = std::make_shared<LinearElastic>(parameters.section("elastic"));
        formulation = registry.create(element, parameters.section("formulation/" + element));

        // Refined as the box source does it, so that the cells have a local order.
        unsigned int coarse = n_cells, refinements = 0;
        for (; coarse % 2 == 0; coarse /= 2)
          ++refinements;
        dealii::GridGenerator::subdivided_hyper_cube(mesh.triangulation, coarse, 0., n_cells);
        mesh.triangulation.refine_global(refinements);
        nodes = std::make_unique<Nodes<3>>(mesh, formulation->degree());
        PartSetup<3> setup;
        setup.name = "block";
        setup.nodes = nodes.get();
        setup.material = material;
        setup.communicator = MPI_COMM_SELF;
        formulation->initialize(setup);
        partition = std::make_shared<const NodePartition>(
            nodes->owned(), formulation->required_nodes(), MPI_COMM_SELF);
        formulation->set_partition(*partition);
        for (NodalVector *vector : {&position, &velocity, &force})
          vector->reinit(partition);
        mass.reinit(partition, Quantity::scalar);
        formulation->add_mass(mass);
        std::vector<dealii::types::global_dof_index> cell_nodes;
        std::vector<dealii::Point<3>> cell_points;
        for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        {
          nodes->cell_nodes(cell, cell_nodes);
          nodes->cell_points(cell, cell_points);
          for (unsigned int k = 0; k < cell_nodes.size(); ++k)
          {
            const unsigned int i = partition->local_index(cell_nodes[k]);
            for (unsigned int d = 0; d < 3; ++d)
            {
              position.node(i)[d] = cell_points[k][d];
              velocity.node(i)[d] =
                  1e-3 * std::sin(0.2 * cell_points[k][d] + 0.1 * cell_points[k][(d + 1) % 3]);
            }
          }
        }
        time_step = 0.5 * formulation->courant_limit(position).time_step;
      }

      void add_force()
      {
        formulation->add_internal_force({&position, &velocity, time_step}, force);
      }

      void step()
      {
        force.set_zero();
        add_force();
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
        {
          const NodeLanes v =
              load_node(velocity.node(i)) + (time_step / *mass.node(i)) * load_node(force.node(i));
          store_node(v, velocity.node(i));
          store_node(load_node(position.node(i)) + time_step * v, position.node(i));
        }
      }

      Mesh<3> mesh;
      std::shared_ptr<const Material> material;
      std::unique_ptr<Formulation<3>> formulation;
      std::unique_ptr<Nodes<3>> nodes;
      std::shared_ptr<const NodePartition> partition;
      NodalVector position, velocity, force, mass;
      double time_step = 0;
    };

    void run(benchmark::State &state, Model &model, const std::function<void()> &work)
    {
      for (auto _ : state)
        work();
      const double n_cells = model.formulation->n_cells();
      const double n_nodes = model.partition->n_owned();
      const double iterations = static_cast<double>(state.iterations());
      state.counters["cells"] = n_cells;
      state.counters["nodes"] = n_nodes;
      state.counters["time/cell"] = benchmark::Counter(
          n_cells * iterations, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
      state.counters["time/node"] = benchmark::Counter(
          n_nodes * iterations, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    }

    void add(const std::string &label, const std::string &element, const std::string &entries,
             const unsigned int n_cells)
    {
      // Made once, when its first benchmark runs.
      const auto model = std::make_shared<std::unique_ptr<Model>>();
      const auto get = [=]() -> Model &
      {
        if (!*model)
          *model = std::make_unique<Model>(element, entries, n_cells);
        return **model;
      };
      benchmark::RegisterBenchmark(("force/" + label).c_str(), [=](benchmark::State &state)
                                   { run(state, get(), [&]() { get().add_force(); }); })
          ->Unit(benchmark::kMillisecond);
      benchmark::RegisterBenchmark(("step/" + label).c_str(), [=](benchmark::State &state)
                                   { run(state, get(), [&]() { get().step(); }); })
          ->Unit(benchmark::kMillisecond);
      benchmark::RegisterBenchmark(("stiffness/" + label).c_str(),
                                   [=](benchmark::State &state)
                                   {
                                     Model &m = get();
                                     run(state, m,
                                         [&]() {
                                           m.formulation->apply_elastic_stiffness(
                                               m.position, m.velocity, m.time_step, m.force);
                                         });
                                   })
          ->Unit(benchmark::kMillisecond);
    }
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  tombolo::add("hexahedron", "hexahedron", "", 48);
  tombolo::add("fully_integrated_hexahedron", "fully integrated hexahedron", "", 48);
  tombolo::add("lagrange_hexahedron_1", "lagrange hexahedron", "set Degree = 1", 48);
  tombolo::add("lagrange_hexahedron_2", "lagrange hexahedron", "set Degree = 2", 24);
  tombolo::add("lagrange_hexahedron_3", "lagrange hexahedron", "set Degree = 3", 16);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks(); // and with them the meshes, before MPI ends
  return 0;
}
