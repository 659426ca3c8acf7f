// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/json.h>
#include <tombolo/model/model.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/time_table.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  /** The relative L2 errors of a run against the exact solution of its case, at each output. Does
   * nothing where section "Exact solution" is empty. */
  template <int dim>
  class ExactErrors
  {
  public:
    /** Throws InputError. */
    explicit ExactErrors(const Section &section)
    {
      if (ExactSolution<dim>::is_given(section))
        exact = std::make_unique<ExactSolution<dim>>(section);
      if (exact == nullptr)
        return;
      exact->list(records);
      records.items(output_errors)
          .numbers("errors",
                   [](Errors &errors) -> std::vector<double *>
                   {
                     return {&errors.time, &errors.axial_stress, &errors.stress, &errors.velocity,
                             &errors.temperature};
                   });
    }

    /** Null where the case has no exact solution. */
    const ExactSolution<dim> *solution() const
    {
      return exact.get();
    }

    /** Computes the errors at the present time and adds them to the present row of @p statistics.
     * Collective. */
    void evaluate(const Model<dim> &model, const Clock &clock, TimeTable &statistics)
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
        static_cast<ExactSolutionErrors &>(errors) =
            exact->errors(formulations, model.state.initial_position, model.state.velocity,
                          model.state.mass, clock.time, clock.velocity_time());
      }
      if (exact->has_temperature())
        errors.temperature = exact->temperature_error(model.state.initial_position,
                                                      model.heat->state.present_temperature,
                                                      model.heat->bridge.mass(), clock.time);
      output_errors.push_back(errors);
      for_names(errors, [&](const std::string &name, const std::string &, const double error)
                { statistics.add("relative error of " + name, "1", error); });
    }

    /** The errors of the last evaluate() for the screen; empty at the start, where they are those
     * of the initial conditions. */
    std::string report() const
    {
      if (output_errors.empty() || !(output_errors.back().time > 0.))
        return "";
      const Errors &errors = output_errors.back();
      std::ostringstream line;
      line.precision(4);
      line << "  t = " << errors.time << ": relative L2 error";
      const char *separator = " of ";
      const auto print = [&](const char *label, const double error)
      {
        line << separator << label << ' ';
        separator = ", of ";
        if (std::isfinite(error))
          line << error;
        else
          line << "undefined (the exact one vanishes)";
      };
      if (exact->has_stress())
      {
        print("stress xx", errors.axial_stress);
        print("all stress", errors.stress);
      }
      if (exact->has_velocity())
        print("velocity", errors.velocity);
      if (exact->has_temperature())
        print("temperature", errors.temperature);
      return line.str();
    }

    /** Adds `errors`, a list over outputs. */
    void add_to(Json &results) const
    {
      if (exact == nullptr)
        return;
      Json list = Json::array();
      for (const Errors &errors : output_errors)
      {
        Json entry = Json::object();
        entry["time"] = errors.time;
        for_names(errors, [&](const std::string &, const std::string &key, const double error)
                  { entry[key] = error; });
        list.push_back(entry);
      }
      results["errors"] = list;
    }

    /** What is kept from output to output. */
    Records records;

  private:
    struct Errors : ExactSolutionErrors
    {
      double time = 0;
      double temperature = 0;
    };

    /** Calls @p use(name, key, error) for each of those that the case has. */
    template <typename Use>
    void for_names(const Errors &errors, const Use &use) const
    {
      if (exact->has_stress())
      {
        use("stress xx", "stress_xx", errors.axial_stress);
        use("stress", "stress", errors.stress);
      }
      if (exact->has_velocity())
        use("velocity", "velocity", errors.velocity);
      if (exact->has_temperature())
        use("temperature", "temperature", errors.temperature);
    }

    std::unique_ptr<ExactSolution<dim>> exact;
    std::vector<Errors> output_errors;
  };
} // namespace tombolo
