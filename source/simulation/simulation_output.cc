// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/rank_balance.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    void print_report(const Output<dim> &output, Log &log)
    {
      const std::string report = output.report();
      if (!report.empty())
        log.print(report);
    }

    /** Throws RunError on all ranks where the energy balance is off by more than @p limit of the
     * largest total energy. Collective. */
    template <int dim>
    void check_energy_balance(const Model<dim> &model, const EnergyBalance &balance,
                              const Clock &clock, const double limit)
    {
      if (limit == 0. || std::abs(balance.error) <= limit)
        return;
      // The balance of a body at rest is all round-off.
      double speed = 0, mass = 0;
      for (const Part<dim> &part : model.parts)
        speed = std::max(speed, part.material->longitudinal_wave_speed());
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        mass += *model.bridge->mass().node(i);
      mass = Utilities::MPI::sum(mass, model.communicator);
      const double put_in = balance.initial_total + balance.external;
      constexpr double round_off = 1e-20;
      if (std::isfinite(balance.total) &&
          std::abs(balance.total - put_in) <= round_off * mass * speed * speed)
        return;
      std::ostringstream message;
      message.precision(4);
      message << "The energy balance does not hold at time " << clock.time << ", step "
              << clock.step << ": a total energy of " << balance.total << ", where " << put_in
              << " was put in (error " << balance.error << ", allowed " << limit
              << "). The motion is not stable: a smaller step (`Time step/Safety factor`, or the "
                 "spectral `Estimator`) or another formulation may help. `Largest energy error` "
                 "is the limit.";
      throw RunError(message.str());
    }
  } // namespace

  template <int dim>
  void Simulation<dim>::write_output()
  {
    statistics->begin_row();
    statistics->add("time", "T", run_clock.time);
    statistics->add("step", "1", static_cast<double>(run_clock.step));
    statistics->add("time step", "T", run_clock.next_step);
    if (model.has_mechanics)
    {
      last_balance = energy_balance();
      add_mechanical_statistics();
    }
    if (model.heat)
    {
      last_heat_balance = thermal_step->balance(model);
      if (!std::isfinite(last_heat_balance.error))
        throw RunError("The balance of heat is not finite at time " +
                       std::to_string(run_clock.time) +
                       ": densities, heat capacities or temperatures are beyond all numbers.");
      add_thermal_statistics();
    }
    add_exact_errors();
    for (const auto &output : outputs)
    {
      output->write(view(), *statistics);
      print_report(*output, log);
    }
    // A row that nobody can read helps nobody; the message has the numbers.
    if (!model.has_mechanics || std::isfinite(last_balance.total) || largest_energy_error == 0)
      statistics->write_row();
    if (model.has_mechanics)
      check_energy_balance(model, last_balance, run_clock, largest_energy_error);
  }

  template <int dim>
  void Simulation<dim>::add_mechanical_statistics()
  {
    const EnergyBalance &b = last_balance;
    for (const EnergyAccounts::Account &account : b.energies.accounts())
    {
      statistics->add(account.name, "M L^2/T^2", account.value);
      if (account.name == "kinetic energy")
        statistics->add("smoothed kinetic energy", "M L^2/T^2", b.smoothed_kinetic);
    }
    statistics->add("total energy", "M L^2/T^2", b.total);
    statistics->add("energy error", "1", b.error);
    for (unsigned int d = 0; d < dim; ++d)
      statistics->add(std::string("momentum ") + "xyz"[d], "M L/T", b.momentum[d]);
    for (unsigned int d = 0; d < dim; ++d)
      statistics->add(std::string("impulse ") + "xyz"[d], "M L/T", b.impulse[d]);
    statistics->add("momentum drift", "1", b.momentum_drift);
    for (unsigned int d = dim == 2 ? 2 : 0; d < 3; ++d)
      statistics->add(std::string("angular momentum ") + "xyz"[d], "M L^2/T",
                      b.angular_momentum[d]);
    statistics->add("angular momentum drift", "1", b.angular_momentum_drift);
    statistics->add("lattice mode share", "1", b.short_wave_share);
    for (const auto &process : model.processes)
      process->report(model, *statistics);
    add_extremes();
  }

  template <int dim>
  void Simulation<dim>::add_extremes()
  {
    double largest[2] = {0., 0.}; // speed, stress component
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double *const v = model.state.velocity.node(i);
      largest[0] = std::max(largest[0], v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    for (const Part<dim> &part : model.parts)
      for (unsigned int c = 0; c < 6; ++c)
      {
        const MaterialPoints &points = part.formulation->points();
        const double *const stress = points.component(MaterialPoints::stress, c);
        const double *const volume = points.component(MaterialPoints::volume, 0);
        for (unsigned int i = 0; i < points.size(); ++i)
          if (volume[i] > 0.) // not an unused lane of a batch of cells
            largest[1] = std::max(largest[1], std::abs(stress[i]));
      }
    statistics->add("largest speed", "L/T",
                    std::sqrt(Utilities::MPI::max(largest[0], communicator)));
    statistics->add("largest stress component", "M/(L T^2)",
                    Utilities::MPI::max(largest[1], communicator));
    const auto add_largest = [&](const std::string &field, const std::string &unit)
    {
      bool is_known = false;
      double value = std::numeric_limits<double>::lowest();
      for (const Part<dim> &part : model.parts)
      {
        const MaterialPoints &points = part.formulation->points();
        const unsigned int f = points.find_field(field);
        if (f == points.fields().size())
          continue;
        is_known = true;
        const double *const values = points.component(f, 0);
        const double *const volume = points.component(MaterialPoints::volume, 0);
        for (unsigned int i = 0; i < points.size(); ++i)
          if (volume[i] > 0.)
            value = std::max(value, values[i]);
      }
      if (is_known)
        statistics->add("largest " + field, unit, Utilities::MPI::max(value, communicator));
    };
    add_largest("effective plastic strain", "1");
    add_largest("temperature", "K");
  }

  template <int dim>
  void Simulation<dim>::add_thermal_statistics()
  {
    const HeatBalance &b = last_heat_balance;
    const std::string energy = "M L^2/T^2";
    statistics->add("thermal steps", "1", static_cast<double>(thermal_step->n_steps()));
    for (const EnergyAccounts::Account &account : b.heat.accounts())
      statistics->add(account.name, energy, account.value);
    for (const auto &process : model.processes)
      process->report_heat(model, *statistics);
    statistics->add("heat balance error", "1", b.error);
    double smallest = std::numeric_limits<double>::max(), largest = -smallest;
    const NodalVector &temperature = model.heat->state.present_temperature;
    for (unsigned int i = 0; i < temperature.partition()->n_owned(); ++i)
    {
      if (*model.heat->bridge.mass().node(i) == 0.) // all its cells were removed
        continue;
      smallest = std::min(smallest, *temperature.node(i));
      largest = std::max(largest, *temperature.node(i));
    }
    statistics->add("smallest nodal temperature", "temperature",
                    Utilities::MPI::min(smallest, communicator));
    statistics->add("largest nodal temperature", "temperature",
                    Utilities::MPI::max(largest, communicator));
  }

  template <int dim>
  void Simulation<dim>::add_exact_errors()
  {
    if (!exact_solution)
      return;
    std::vector<const Formulation<dim> *> formulations;
    for (const Part<dim> &part : model.parts)
      formulations.push_back(part.formulation.get());
    const ExactSolutionErrors errors =
        exact_solution->has_stress() || exact_solution->has_velocity()
            ? exact_solution->errors(formulations, model.state.initial_position,
                                     model.state.velocity, model.state.mass, run_clock.time,
                                     run_clock.time - 0.5 * run_clock.previous_step)
            : ExactSolutionErrors();
    const double temperature_error =
        exact_solution->has_temperature()
            ? exact_solution->temperature_error(model.state.initial_position,
                                                model.heat->state.present_temperature,
                                                model.heat->bridge.mass(), run_clock.time)
            : 0.;
    exact_errors.insert(exact_errors.end(), {run_clock.time, errors.axial_stress, errors.stress,
                                             errors.velocity, temperature_error});
    if (exact_solution->has_stress())
    {
      statistics->add("relative error of stress xx", "1", errors.axial_stress);
      statistics->add("relative error of stress", "1", errors.stress);
    }
    if (exact_solution->has_velocity())
      statistics->add("relative error of velocity", "1", errors.velocity);
    if (exact_solution->has_temperature())
      statistics->add("relative error of temperature", "1", temperature_error);
    if (run_clock.time > 0.)
    {
      std::ostringstream line;
      line.precision(4);
      line << "  t = " << run_clock.time << ": relative L2 error";
      const auto print = [&](const char *of_what, const double error)
      {
        line << of_what;
        if (std::isfinite(error))
          line << error;
        else
          line << "undefined (the exact one vanishes)";
      };
      if (exact_solution->has_stress())
      {
        print(" of stress xx ", errors.axial_stress);
        print(", of all stress ", errors.stress);
      }
      if (exact_solution->has_velocity())
        print(exact_solution->has_stress() ? ", of velocity " : " of velocity ", errors.velocity);
      if (exact_solution->has_temperature())
        print(" of temperature ", temperature_error);
      log.print(line.str());
    }
  }

  template <int dim>
  void Simulation<dim>::write_summary(const std::string &ended)
  {
    const auto counts = model.counts();
    // Seconds are those of this process, and so are the steps that they are shared among.
    const double steps = static_cast<double>(std::max(run_clock.step - first_step, 1ul));
    summary.set_units(unit_labels);
    summary["title"] = parameters.section("").get("Title");
    summary["ended"] = ended;
    summary["ranks"] = Utilities::MPI::n_mpi_processes(communicator);
    summary["dimension"] = dim;
    summary["nodes"] = counts.nodes;
    summary["fe_cells"] = counts.cells;
    summary["particles"] = counts.particles;
    summary["shared_nodes"] = counts.shared_nodes;
    summary["steps"] = run_clock.step;
    summary["simulated_time"] = run_clock.time;
    if (model.has_mechanics)
    {
      summary["time_step_min"] = step_size.smallest();
      summary["time_step_max"] = step_size.largest();
      summary["time_step_limit"] = step_size.limit().time_step;
      summary["time_step_estimates"] = step_size.n_estimates();
      summary["energy_error_relative"] = last_balance.error;
      summary["momentum_drift_relative"] = last_balance.momentum_drift;
      summary["angular_momentum_drift_relative"] = last_balance.angular_momentum_drift;
      summary["lattice_mode_share"] = last_balance.short_wave_share;
    }
    for (const auto &process : model.processes)
      process->summarize(model, *statistics, summary.document());
    if (model.heat)
    {
      summary["thermal_steps"] = thermal_step->n_steps();
      summary["thermal_step_min"] = thermal_step->smallest_step();
      summary["thermal_step_max"] = thermal_step->largest_step();
      thermal_step->add_to_summary(summary);
      if (thermal_step->limit().time_step < 1e299)
        summary["thermal_step_limit"] = thermal_step->limit().time_step;
      summary["heat_balance_error_relative"] = last_heat_balance.error;
    }
    summary["step_seconds"] = loop_seconds;
    summary["rank_balance"] = describe_rank_balance(*model.state.partition(), loop_seconds, steps);

    // The slowest rank determines the wall time of each phase.
    Json phases = Json::object();
    double of_elements = 0, of_particles = 0;
    for (const char *phase : {"neighbourhoods", "smoothing", "element forces", "particle forces",
                              "loads", "acceleration", "motion", "processes after the motion"})
    {
      double seconds = 0;
      for (const auto &[name, value] : step.times().seconds())
        if (name == phase)
          seconds = value;
      seconds = Utilities::MPI::max(seconds, communicator);
      phases[phase] = seconds;
      const std::string name = phase;
      if (name == "element forces")
        of_elements += seconds;
      if (name == "particle forces" || name == "smoothing" || name == "neighbourhoods")
        of_particles += seconds;
    }
    if (model.heat)
    {
      const double seconds = Utilities::MPI::max(thermal_step->seconds(), communicator);
      phases["heat"] = seconds;
      summary["ns_per_node_thermal_step"] =
          1e9 * Utilities::MPI::n_mpi_processes(communicator) * seconds /
          (static_cast<double>(std::max(thermal_step->n_steps(), 1ul)) *
           static_cast<double>(counts.nodes));
    }
    summary["seconds_per_phase"] = phases;
    const double n_ranks = Utilities::MPI::n_mpi_processes(communicator);
    // Whole steps where there is one kind; its own phases where there are two.
    if (counts.cells > 0 && loop_seconds > 0)
      summary["ns_per_cell_step"] = 1e9 * n_ranks *
                                    (counts.particles > 0 ? of_elements : loop_seconds) /
                                    (steps * static_cast<double>(counts.cells));
    if (counts.particles > 0 && loop_seconds > 0)
      summary["ns_per_particle_step"] = 1e9 * n_ranks *
                                        (counts.cells > 0 ? of_particles : loop_seconds) /
                                        (steps * static_cast<double>(counts.particles));
    if (loop_seconds > 0)
      summary["ns_per_node_step"] =
          1e9 * n_ranks * loop_seconds / (steps * static_cast<double>(counts.nodes));
    if (is_resumed)
    {
      summary["resumed_from_step"] = first_step;
      summary["earlier_wall_seconds"] = earlier_wall_seconds;
    }
    if (exact_solution)
    {
      Json errors = Json::array();
      for (std::size_t i = 0; i + 4 < exact_errors.size(); i += 5)
      {
        Json entry = Json::object();
        entry["time"] = exact_errors[i];
        if (exact_solution->has_stress())
        {
          entry["stress_xx"] = exact_errors[i + 1];
          entry["stress"] = exact_errors[i + 2];
        }
        if (exact_solution->has_velocity())
          entry["velocity"] = exact_errors[i + 3];
        if (exact_solution->has_temperature())
          entry["temperature"] = exact_errors[i + 4];
        errors.push_back(entry);
      }
      summary.results()["errors"] = errors;
    }
    for (const auto &output : outputs)
    {
      output->finish(summary.results());
      print_report(*output, log);
    }
    summary.write(*directory);
  }

  template void Simulation<2>::write_output();
  template void Simulation<3>::write_output();
  template void Simulation<2>::write_summary(const std::string &);
  template void Simulation<3>::write_summary(const std::string &);
} // namespace tombolo
