// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/mechanics/step_size.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: strip_operators [--validate] FILE.prm...\n"
      "Builds the model of each plane scene, and writes into FILE.operators what its operators of\n"
      "small motion make of unit vectors, for scripts/reflection_study.\n"
      "  --validate  read the files, write nothing, say what is wrong\n";

  void declare_parameters(Parameters &parameters)
  {
    declare_model<2>(parameters);
    declare_section<StepSize<2>>(parameters, "Time step");
    const Entries probe = Entries(parameters.handler()).subsection("Probe");
    const dealii::Patterns::List point(dealii::Patterns::Double(), 2, 2);
    probe.entry("Lower corner", mandatory, point, "L",
                "Operators are applied to the unit vectors of the nodes in this box.");
    probe.entry("Upper corner", mandatory, point, "L", "See Lower corner.");
  }

  /** The nodes within the box of section Probe. */
  std::vector<unsigned int> probed_nodes(const Section &section, const NodalVector &position)
  {
    const std::vector<double> lower = section.get_doubles("Lower corner");
    const std::vector<double> upper = section.get_doubles("Upper corner");
    std::vector<unsigned int> nodes;
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
    {
      const double *const x = position.node(i);
      if (x[0] > lower[0] && x[0] < upper[0] && x[1] > lower[1] && x[1] < upper[1])
        nodes.push_back(i);
    }
    return nodes;
  }

  /** Largest speed of P waves over the spacing of particles, which the lattice filter is scaled
   * with [1/T]; 0 without particles. */
  double filter_rate(const Model<2> &model)
  {
    double rate = 0;
    for (const ParticleFormulation<2> *const particles : model.particle_parts())
      rate = std::max(rate, particles->material().longitudinal_wave_speed() /
                                particles->smallest_spacing());
    return rate;
  }

  using Operator = std::function<void(const NodalVector &, NodalVector &)>;

  /** The bridge's smoothing S, the adjoint of S as chosen, T = I - ΦS, and M⁻¹ K and M⁻¹ (K + C) of
   * the nodal masses, where C is artificial viscosity. */
  std::vector<Operator> operators_of_motion(const Model<2> &model, Assembly<2> &assembly)
  {
    Bridge &bridge = *model.bridge;
    // K + 2/Δt C for a step Δt
    const auto stiffness = [&model, &assembly, &bridge](const double time_step)
    {
      return [&model, &assembly, &bridge, time_step](const NodalVector &in, NodalVector &out)
      {
        const NodalVector &position = model.state.position;
        assembly.assemble(
            bridge, in, out,
            [&](const Part<2> &part, const NodalVector &seen, NodalVector &result)
            { part.formulation->apply_elastic_stiffness(position, seen, time_step, result); });
        for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
          store_node(load_node(out.node(i)) / load_node(bridge.nodal_mass().node(i)), out.node(i));
      };
    };
    constexpr double long_step = 1e200;
    return {[&](const NodalVector &in, NodalVector &out) { bridge.apply_smoothing(in, out); },
            [&](const NodalVector &in, NodalVector &out) { bridge.apply_adjoint(in, out); },
            [&](const NodalVector &in, NodalVector &out) { bridge.apply_short_wave_part(in, out); },
            stiffness(long_step), stiffness(2.)};
  }

  /** How many nodes there are and how many of them are probed, the stable step, the rate of the
   * filter; x and y of each node; m̂ and m in x and y of each node; the numbers of the probed nodes;
   * x and y of the response of each node, by operator, probed node and component. */
  std::vector<double> probed_operators(const Parameters &parameters)
  {
    Model<2> model(parameters, MPI_COMM_SELF);
    SpectralEstimator<2> estimator(parameters.section("Time step").subsection("spectral"));
    const NodalVector &position = model.state.initial_position;
    const unsigned int n_nodes = position.partition()->n_owned();
    const std::vector<unsigned int> probed = probed_nodes(parameters.section("Probe"), position);

    std::vector<double> numbers = {double(n_nodes), double(probed.size()),
                                   estimator.estimate(model).time_step, filter_rate(model)};
    const auto add_components = [&numbers](const double *const values)
    { numbers.insert(numbers.end(), values, values + 2); };
    for (unsigned int i = 0; i < n_nodes; ++i)
      add_components(position.node(i));
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      numbers.push_back(*model.bridge->mass().node(i));
      add_components(model.bridge->nodal_mass().node(i));
    }
    numbers.insert(numbers.end(), probed.begin(), probed.end());

    Assembly<2> assembly(model.parts);
    NodalVector unit, response;
    unit.reinit(position.partition());
    response.reinit(position.partition());
    for (const Operator &apply : operators_of_motion(model, assembly))
      for (const unsigned int i : probed)
        for (unsigned int component = 0; component < 2; ++component)
        {
          unit.node(i)[component] = 1.;
          apply(unit, response);
          unit.node(i)[component] = 0.;
          for (unsigned int j = 0; j < n_nodes; ++j)
            add_components(response.node(j));
        }
    return numbers;
  }

  /** Writes doubles to a file next to a parameter file. Throws RunError. */
  void write(const std::string &file, const std::vector<double> &numbers)
  {
    std::ofstream out(file.substr(0, file.rfind('.')) + ".operators", std::ios::binary);
    out.write(reinterpret_cast<const char *>(numbers.data()),
              static_cast<std::streamsize>(numbers.size() * sizeof(double)));
    if (!out.flush())
      throw RunError("The operators of " + file + " cannot be written.");
  }

  int run(const int argc, char **argv)
  {
    if (argc < 2 || argv[1] == std::string("--help"))
    {
      std::cout << help;
      return argc < 2 ? 1 : 0;
    }
    const bool validates = argv[1] == std::string("--validate");
    for (int k = validates ? 2 : 1; k < argc; ++k)
    {
      const std::string file(argv[k]);
      Parameters parameters(MPI_COMM_SELF);
      parameters.read_file(file);
      load_plugin_libraries(parameters, MPI_COMM_SELF);
      declare_parameters(parameters);
      parameters.assign();
      if (!validates)
        write(file, probed_operators(parameters));
    }
    return 0;
  }
} // namespace

int main(int argc, char **argv)
{
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The probing stopped");
}
