// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

/** Nanoseconds per cell or particle of the thermal stage (the smoothed temperature field and the
 * heat that comes to the nodes, eqs 28-39), and of the mechanical step of the same scene, measured
 * in turn: medians. Their ratio is what one explicit step of heat costs in mechanical ones. */
namespace tombolo
{
  namespace
  {
    struct Case
    {
      std::string label, formulation, options;
      unsigned int n_along_axis;
      bool has_tables = false;
    };

    /** A block of copper that is warmer on one side, and moves a little. */
    struct Body
    {
      explicit Body(const Case &of) : parameters(MPI_COMM_SELF)
      {
        const std::string n = std::to_string(of.n_along_axis);
        parameters.read_text(
            "set Dimension = 3\nset Materials = m\nset Parts = a\nset Initial conditions = warm\n"
            "subsection Mesh\nset Type = box\nsubsection box\nset Upper corner = 0.04, 0.04, 0.04\n"
            "set Cells = " +
                n + ", " + n + ", " + n +
                "\nend\nend\n"
                "subsection Material: m\nset Model = elastic\nsubsection elastic\n"
                "set Density = 8960\nset Young's modulus = 124e9\nset Poisson's ratio = 0.34\n"
                "set Thermal expansion = 1.7e-5\nend\nsubsection Heat\n" +
                (of.has_tables ? "set Specific heat capacity = 200: 370, 400: 390, 1000: 450\n"
                                 "set Conductivity = 200: 410, 400: 390, 1000: 350\n"
                               : "set Specific heat capacity = 383\nset Conductivity = 386\n") +
                "set Initial temperature = 298\nend\nend\n"
                "subsection Initial condition: warm\nset Temperature = 298 + 1000*x\n"
                "set Velocity = 0.1*y; 0; 0\nend\n"
                "subsection Part: a\nset Cells = all\nset Material = m\nset Formulation = " +
                of.formulation + "\nsubsection " + of.formulation + "\n" + of.options +
                "\nend\nend\n",
            "benchmark.prm");
        declare_model<3>(parameters);
        parameters.assign();
        model = std::make_unique<Model<3>>(parameters, MPI_COMM_SELF);
        step = std::make_unique<MechanicalStep<3>>(*model);
        thermal_step = std::make_unique<ThermalStep<3>>(parameters.section("Heat"));
        thermal_step->start(*model, 0.);
        const auto &partition = model->state.partition();
        smoothed.reinit(partition, Quantity::scalars);
        rate.reinit(partition, Quantity::scalar);
        condition_heat.assign(model->heat->conditions.n_conditions(), 0.);
        model->bridge->apply_smoothing(model->state.unsmoothed_velocity, model->state.velocity);
        clock.next_step =
            0.5 * model->parts[0].formulation->courant_limit(model->state.position).time_step;
      }

      void advance_mechanics()
      {
        step->evaluate(clock);
        step->complete(clock);
        step->advance(clock);
        clock.advance();
      }

      void find_heat_rate()
      {
        ThermalModel<3> &heat = *model->heat;
        const NodalVector &position = model->state.position;
        heat.find_field(heat.state.unsmoothed_temperature, heat.state.temperature);
        heat.heat_rate(position, heat.state.temperature, clock.time, rate, condition_heat);
      }

      Parameters parameters;
      EnergyLedger ledger;
      std::unique_ptr<Model<3>> model;
      std::unique_ptr<MechanicalStep<3>> step;
      std::unique_ptr<ThermalStep<3>> thermal_step;
      NodalVector smoothed, rate;
      std::vector<double> condition_heat;
      Clock clock;
    };

    template <typename Work>
    double seconds_of(const Work &work)
    {
      const auto start = std::chrono::steady_clock::now();
      work();
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /** The median leaves out what other processes used. */
    double median(std::vector<double> values)
    {
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      return *middle;
    }

    void run(benchmark::State &state, const Case &of)
    {
      Body body(of);
      for (unsigned int k = 0; k < 5; ++k)
      {
        body.advance_mechanics();
        body.find_heat_rate();
      }
      std::vector<double> mechanics_seconds, heat_seconds;
      for (auto _ : state)
      {
        mechanics_seconds.push_back(seconds_of([&]() { body.advance_mechanics(); }));
        heat_seconds.push_back(seconds_of([&]() { body.find_heat_rate(); }));
        state.SetIterationTime(heat_seconds.back());
      }
      const Formulation<3> &formulation = *body.model->parts[0].formulation;
      const bool has_cells = formulation.n_cells() > 0;
      const double n = has_cells ? formulation.n_cells() : formulation.points().size();
      const std::string each = has_cells ? "ns/cell" : "ns/particle";
      const double n_nodes = static_cast<double>(body.model->state.partition()->n_global());
      const double heat = median(heat_seconds), mechanics = median(mechanics_seconds);
      state.counters["heat " + each] = heat / n * 1e9;
      state.counters["mechanics " + each] = mechanics / n * 1e9;
      state.counters["heat/mechanics"] = heat / mechanics;
      state.counters["heat ns/node"] = heat / n_nodes * 1e9;
    }

    void add(const Case &of)
    {
      benchmark::RegisterBenchmark(of.label.c_str(),
                                   [=](benchmark::State &state) { run(state, of); })
          ->UseManualTime()
          ->Iterations(60)
          ->Unit(benchmark::kMillisecond);
    }
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  using namespace tombolo;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const std::string particles = "momentum consistent particle";
  add({"hexahedron", "hexahedron", "", 40});
  add({"hexahedron_tables", "hexahedron", "", 40, true});
  add({"fully_integrated_hexahedron", "fully integrated hexahedron", "", 40});
  add({"lagrange_hexahedron_3", "lagrange hexahedron", "set Degree = 3", 13});
  add({"particles_paper", particles, "set Smoothing = paper", 40});
  add({"particles_affine", particles, "set Smoothing = affine", 40});
  add({"particles_affine_tables", particles, "set Smoothing = affine", 40, true});
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}
