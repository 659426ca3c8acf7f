// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/base/log.h>
#include <tombolo/model/model.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/output.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** The outputs of a run, called together with a view of its model. All functions are collective;
   * see Output for their order. */
  template <int dim>
  class RunOutputs
  {
  public:
    /** Makes what section Output asks for. Throws InputError. */
    explicit RunOutputs(const Section &section);

    /** Takes the model, instead of an earlier one where there was one, and the exact solution of
     * the case (null for none), which must outlive this. */
    void attach(const Model<dim> &model, const ExactSolution<dim> *exact_solution);

    /** Throws InputError where an output does not fit to the model. */
    void check(const Clock &clock)
    {
      for (const auto &output : outputs)
        output->check(view_at(clock));
    }

    void start(const Clock &clock, const OutputDirectory &directory, const UnitLabels &unit_labels)
    {
      for (const auto &output : outputs)
        output->start(view_at(clock), directory, unit_labels);
    }

    void after_step(const Clock &clock, const bool ends_at_rest)
    {
      view.ends_at_rest = ends_at_rest;
      for (const auto &output : outputs)
        output->after_step(view_at(clock));
    }

    /** Adds to the present row of @p statistics, and prints the reports of outputs. */
    void write(const Clock &clock, TimeTable &statistics, Log &log);

    /** What outputs keep. One without state in the checkpoint, since the earlier run did not have
     * it, starts anew. */
    Records records;

    void finish(Json &results, Log &log);

  private:
    const OutputView<dim> &view_at(const Clock &clock);

    std::vector<std::string> names;
    std::vector<std::unique_ptr<Output<dim>>> outputs;
    OutputView<dim> view;
  };
} // namespace tombolo
