// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/advice.h>
#include <tombolo/simulation/energy_check.h>
#include <tombolo/simulation/run_summary.h>
#include <tombolo/simulation/simulation.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  template <int dim>
  void Simulation<dim>::write_row(const bool is_output)
  {
    statistics.begin_row(run_clock.time, run_clock.step);
    statistics.add("time step", "T", run_clock.next_step);
    if (model->has_mechanics)
    {
      last_balance = energy_balance();
      add_mechanical_statistics(*model, last_balance, statistics);
      if (statics)
        statics->report(statistics);
    }
    if (model->heat)
    {
      last_heat_balance = thermal_step->balance(*model);
      check_heat_balance(last_heat_balance, run_clock);
      add_thermal_statistics(*model, *thermal_step, last_heat_balance, statistics);
    }
    if (is_output)
    {
      exact_errors.evaluate(*model, run_clock, statistics);
      if (const std::string report = exact_errors.report(); !report.empty())
        log.print(report);
      outputs.write(run_clock, statistics, log);
    }
    // Where the energy is not finite, the message of the failure has the numbers.
    if (!model->has_mechanics || std::isfinite(last_balance.total) || largest_energy_error == 0)
      statistics.write_row();
    print_warnings(*model, run_clock, Process<dim>::Occasion::row, log);
    if (model->has_mechanics)
      check_energy_balance(*model, last_balance, run_clock, largest_energy_error, step_size);
  }

  template <int dim>
  void Simulation<dim>::write_summary(const std::string &ended)
  {
    summary.set_units(UnitLabels(parameters.section("")));
    summary["title"] = parameters.section("").get("Title");
    summary["ended"] = ended;
    add_model_to_summary(*model, run_clock, summary);
    if (model->has_mechanics)
      add_mechanics_to_summary(step_size, last_balance, summary);
    if (statics)
      statics->add_to_summary(summary.document());
    for (const auto &process : model->processes)
      process->observed.results(statistics, summary.document());
    if (model->heat)
      add_heat_to_summary(*thermal_step, last_heat_balance, summary);
    // The wall time is that of this process, and so are the steps that it is shared among.
    const auto n_steps = std::max(run_clock.step - resumption.first_step, 1ul);
    add_costs_to_summary(*model, step, thermal_step.get(), seconds.of_steps(),
                         static_cast<double>(n_steps), summary);
    if (resumption.is_resumed)
    {
      summary["resumed_from_step"] = resumption.first_step;
      summary["earlier_wall_seconds"] = seconds.before_resumption;
    }
    print_warnings(*model, run_clock, Process<dim>::Occasion::end, log);
    exact_errors.add_to(summary.results());
    outputs.finish(summary.results(), log);
    summary.write(*directory);
  }

  template void Simulation<2>::write_row(bool);
  template void Simulation<3>::write_row(bool);
  template void Simulation<2>::write_summary(const std::string &);
  template void Simulation<3>::write_summary(const std::string &);
} // namespace tombolo
