// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/json.h>
#include <tombolo/model/model.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/time_table.h>

#include <memory>
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
    explicit ExactErrors(const Section &section);

    /** Null where the case has no exact solution. */
    const ExactSolution<dim> *solution() const
    {
      return exact.get();
    }

    /** Computes the errors at the present time and adds them to the present row of @p statistics.
     * Collective. */
    void evaluate(const Model<dim> &model, const Clock &clock, TimeTable &statistics);

    /** The errors of the last evaluate() for the screen; empty at the start, where they are those
     * of the initial conditions. */
    std::string report() const;

    /** Adds `errors`, a list over outputs. */
    void add_to(Json &results) const;

    /** What is kept from output to output. */
    Records records;

  private:
    struct Errors
    {
      double time = 0;
      double axial_stress = 0;
      double stress = 0;
      double velocity = 0;
      double temperature = 0;
    };

    std::unique_ptr<ExactSolution<dim>> exact;
    std::vector<Errors> of_outputs;
  };
} // namespace tombolo
