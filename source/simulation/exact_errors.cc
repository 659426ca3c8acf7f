// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/exact_errors.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

namespace tombolo
{
  template <int dim>
  ExactErrors<dim>::ExactErrors(const Section &section)
  {
    if (ExactSolution<dim>::is_given(section))
      exact = std::make_unique<ExactSolution<dim>>(section);
    if (exact == nullptr)
      return;
    exact->list(records);
    records.items(of_outputs)
        .numbers("errors",
                 [](Errors &errors) -> std::vector<double *>
                 {
                   return {&errors.time, &errors.axial_stress, &errors.stress, &errors.velocity,
                           &errors.temperature};
                 });
  }

  template <int dim>
  void ExactErrors<dim>::evaluate(const Model<dim> &model, const Clock &clock,
                                  TimeTable &statistics)
  {
    if (exact == nullptr)
      return;
    Errors errors;
    errors.time = clock.time;
    if (exact->has_stress() || exact->has_velocity())
    {
      std::vector<const Formulation<dim> *> formulations;
      for (const Part<dim> &part : model.parts)
        formulations.push_back(part.formulation.get());
      const ExactSolutionErrors mechanical =
          exact->errors(formulations, model.state.initial_position, model.state.velocity,
                        model.state.mass, clock.time, clock.time - 0.5 * clock.previous_step);
      errors.axial_stress = mechanical.axial_stress;
      errors.stress = mechanical.stress;
      errors.velocity = mechanical.velocity;
    }
    if (exact->has_temperature())
      errors.temperature = exact->temperature_error(model.state.initial_position,
                                                    model.heat->state.present_temperature,
                                                    model.heat->bridge.mass(), clock.time);
    of_outputs.push_back(errors);

    if (exact->has_stress())
    {
      statistics.add("relative error of stress xx", "1", errors.axial_stress);
      statistics.add("relative error of stress", "1", errors.stress);
    }
    if (exact->has_velocity())
      statistics.add("relative error of velocity", "1", errors.velocity);
    if (exact->has_temperature())
      statistics.add("relative error of temperature", "1", errors.temperature);
  }

  template <int dim>
  std::string ExactErrors<dim>::report() const
  {
    if (of_outputs.empty() || !(of_outputs.back().time > 0.))
      return "";
    const Errors &errors = of_outputs.back();
    std::ostringstream line;
    line.precision(4);
    line << "  t = " << errors.time << ": relative L2 error";
    const auto print = [&](const char *of_what, const double error)
    {
      line << of_what;
      if (std::isfinite(error))
        line << error;
      else
        line << "undefined (the exact one vanishes)";
    };
    if (exact->has_stress())
    {
      print(" of stress xx ", errors.axial_stress);
      print(", of all stress ", errors.stress);
    }
    if (exact->has_velocity())
      print(exact->has_stress() ? ", of velocity " : " of velocity ", errors.velocity);
    if (exact->has_temperature())
      print(" of temperature ", errors.temperature);
    return line.str();
  }

  template <int dim>
  void ExactErrors<dim>::add_to(Json &results) const
  {
    if (exact == nullptr)
      return;
    Json list = Json::array();
    for (const Errors &errors : of_outputs)
    {
      Json entry = Json::object();
      entry["time"] = errors.time;
      if (exact->has_stress())
      {
        entry["stress_xx"] = errors.axial_stress;
        entry["stress"] = errors.stress;
      }
      if (exact->has_velocity())
        entry["velocity"] = errors.velocity;
      if (exact->has_temperature())
        entry["temperature"] = errors.temperature;
      list.push_back(entry);
    }
    results["errors"] = list;
  }

  template class ExactErrors<2>;
  template class ExactErrors<3>;
} // namespace tombolo
