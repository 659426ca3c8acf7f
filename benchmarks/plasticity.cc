// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>
#include <tombolo/physics/mechanics/step_size.h>

#include "../tests/material_testing.h"

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <memory>

/** Nanoseconds of plastic flow: per point and update of the materials alone, and per cell or
 * particle and whole step of blocks that are sheared fast enough to flow everywhere, each beside
 * the elastic one. */
namespace tombolo
{
  namespace
  {
    using namespace testing;

    const char *const elastic = "set Density = 8960\nset Young's modulus = 124e9\n"
                                "set Poisson's ratio = 0.34\n";

    std::string plastic(const std::string &flow_stress, const std::string &entries)
    {
      return elastic + ("set Flow stress = " + flow_stress + "\nsubsection " + flow_stress + "\n") +
             entries + "end\n";
    }

    const std::string linear_entries = "set Yield stress = 65e6\nset Hardening modulus = 1e8\n";
    const std::string table_entries =
        "set Plastic strains = 0, 0.05, 0.1, 0.2, 0.5, 1, 2, 5\nset Temperatures = 298, 500, 800, "
        "1356\nset Flow stresses = 65e6, 2e8, 2.3e8, 2.6e8, 3.4e8, 4.2e8, 5e8, 6e8; 50e6, 1.5e8, "
        "1.8e8, 2e8, 2.8e8, 3.3e8, 4e8, 5e8; 30e6, 1e8, 1.2e8, 1.3e8, 1.7e8, 2e8, 2.5e8, 3e8; 0, "
        "0, 0, 0, 0, 0, 0, 0\n";
    const std::string heat = "set Taylor-Quinney coefficient = 0.9\n"
                             "set Specific heat capacity = 383\nset Initial temperature = 298\n";

    /** Batches of 64 points out of 4096, which stay in the second-level cache. */
    void update(benchmark::State &state, const Material &material, const double strain)
    {
      constexpr unsigned int n = 4096, batch_size = 64;
      MaterialPoints points;
      points.reinit(n, material.internal_variables());
      std::vector<double> increment(n, 0.), shear(n, strain);
      MaterialBatch batch;
      batch.time_increment = 1e-8;
      batch.n = batch_size;
      for (unsigned int f = MaterialPoints::n_standard_fields; f < points.fields().size(); ++f)
        batch.internal_variables.push_back(nullptr);
      const auto sweep = [&]()
      {
        for (unsigned int first = 0; first < n; first += batch_size)
        {
          for (unsigned int c = 0; c < 6; ++c)
          {
            batch.stress[c] = points.component(MaterialPoints::stress, c) + first;
            batch.strain_increment[c] = (c == 5 ? shear : increment).data() + first;
          }
          batch.relative_volume = points.component(MaterialPoints::volume_ratio, 0) + first;
          for (std::size_t k = 0; k < batch.internal_variables.size(); ++k)
            batch.internal_variables[k] =
                points.component(MaterialPoints::n_standard_fields + unsigned(k), 0) + first;
          material.update_stress(batch);
        }
      };
      for (unsigned int k = 0; k < 100; ++k)
        sweep();
      for (auto _ : state)
        sweep();
      state.counters["ns/point"] = benchmark::Counter(
          n * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    }

    void add_update(const std::string &label, const std::string &model, const std::string &entries,
                    const double strain)
    {
      const std::shared_ptr<const Material> material = make_plugin<Material>(model, entries);
      benchmark::RegisterBenchmark(("material/" + label).c_str(), [=](benchmark::State &state)
                                   { update(state, *material, strain); });
    }

    constexpr unsigned int n_along_axis = 40;

    /** A block of edge 40 mm that starts with a shear velocity of this rate. */
    struct Body
    {
      Body(const std::string &formulation, const std::string &options, const std::string &material,
           const std::string &entries, const double rate)
          : parameters(MPI_COMM_SELF)
      {
        const std::string n = std::to_string(n_along_axis);
        parameters.read_text(
            "set Dimension = 3\nset Materials = m\nset Parts = a\nsubsection Mesh\nset Type = box\n"
            "subsection box\nset Upper corner = 0.04, 0.04, 0.04\nset Cells = " +
                n + ", " + n + ", " + n + "\nend\nend\nsubsection Material: m\nset Model = " +
                material + "\nsubsection " + material + "\n" + entries +
                "end\nend\nsubsection Part: a\nset Cells = all\nset Material = m\n"
                "set Formulation = " +
                formulation + "\nsubsection " + formulation + "\n" + options + "\nend\nend\n",
            "benchmark.prm");
        declare_model<3>(parameters);
        parameters.assign();
        model = std::make_unique<Model<3>>(parameters, MPI_COMM_SELF);
        step = std::make_unique<MechanicalStep<3>>(*model);
        NodalVector &v_hat = model->state.unsmoothed_velocity;
        for (unsigned int i = 0; i < model->state.partition()->n_local(); ++i)
          v_hat.node(i)[0] = rate * (model->state.initial_position.node(i)[1] - 0.02);
        model->bridge->apply_smoothing(v_hat, model->state.velocity);
        clock.next_step =
            0.5 * model->parts[0].formulation->courant_limit(model->state.position).time_step;
      }

      void advance()
      {
        step->evaluate(clock);
        step->complete(clock);
        step->advance(clock);
        clock.advance();
      }

      double flowing_share() const
      {
        const MaterialPoints &points = model->parts[0].formulation->points();
        const unsigned int f = points.find_field("effective plastic strain");
        if (f == points.fields().size())
          return 0.;
        double n = 0;
        for (unsigned int i = 0; i < points.size(); ++i)
          n += points.component(f, 0)[i] > 1e-3 ? 1. : 0.;
        return n / points.size();
      }

      Parameters parameters;
      EnergyLedger ledger;
      std::unique_ptr<Model<3>> model;
      std::unique_ptr<MechanicalStep<3>> step;
      Clock clock;
    };

    void add_step(const std::string &label, const std::string &formulation,
                  const std::string &options, const std::string &material,
                  const std::string &entries)
    {
      benchmark::RegisterBenchmark(
          ("step/" + label).c_str(),
          [=](benchmark::State &state)
          {
            Body body(formulation, options, material, entries, material == "elastic" ? 1. : 5e3);
            for (unsigned int n = 0; n < 20; ++n)
              body.advance();
            for (auto _ : state)
              body.advance();
            const bool has_cells = body.model->parts[0].formulation->n_cells() > 0;
            const double n = has_cells ? body.model->parts[0].formulation->n_cells()
                                       : body.model->parts[0].formulation->points().size();
            state.counters["flowing"] = body.flowing_share();
            state.counters[has_cells ? "ns/cell" : "ns/particle"] =
                benchmark::Counter(n * 1e-9, benchmark::Counter::kIsIterationInvariantRate |
                                                 benchmark::Counter::kInvert);
          })
          ->Iterations(60)
          ->Unit(benchmark::kMillisecond);
    }
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  using namespace tombolo;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const std::string j2 = "j2 plasticity";
  const double flowing = 1e-4, resting = 0.;
  add_update("elastic", "elastic", elastic, flowing);
  add_update("linear_hardening", j2, plastic("linear hardening", linear_entries), flowing);
  add_update("tabular", j2, plastic("tabular", table_entries) + heat, flowing);
  add_update("johnson_cook", j2, testing::copper(), flowing);
  add_update("linear_hardening_resting", j2, plastic("linear hardening", linear_entries), resting);
  add_update("johnson_cook_resting", j2, testing::copper(), resting);
  const std::string parts[][3] = {
      {"hexahedron", "hexahedron", ""},
      {"fully_integrated_hexahedron", "fully integrated hexahedron", ""},
      {"particles", "momentum consistent particle", ""}};
  for (const auto &part : parts)
  {
    add_step(part[0] + "/elastic", part[1], part[2], "elastic", elastic);
    add_step(part[0] + "/linear_hardening", part[1], part[2], j2,
             plastic("linear hardening", linear_entries));
    add_step(part[0] + "/johnson_cook", part[1], part[2], j2, testing::copper());
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}
