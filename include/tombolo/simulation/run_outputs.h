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
    /** Makes what section Output requests. Throws InputError. */
    explicit RunOutputs(const Section &section)
        : names(output_names<dim>(section)), outputs(create_outputs<dim>(section))
    {
      for (std::size_t i = 0; i < outputs.size(); ++i)
        records.group(names[i], outputs[i]->records).optional();
    }

    /** Sets the model, instead of an earlier one where there was one, and the exact solution of
     * the case (null for none), which must outlive this. */
    void attach(const Model<dim> &model, const ExactSolution<dim> *exact_solution)
    {
      view = OutputView<dim>();
      view.mesh = &model.mesh;
      view.nodes = model.nodes.get();
      view.part_cells = model.part_cells.get();
      view.state = &model.state;
      view.has_mechanics = model.has_mechanics;
      view.unsmoothed_share = [&model](const unsigned int node)
      { return *model.bridge->mass().node(node) / *model.bridge->lumped_mass().node(node); };
      view.heat = model.heat ? &model.heat->state : nullptr;
      for (const auto &process : model.processes)
        process->observed.views(view);
      for (const Part<dim> &part : model.parts)
      {
        OutputPart<dim> output_part;
        output_part.name = part.name;
        output_part.formulation = part.formulation.get();
        output_part.particles = part.particles;
        output_part.stencils = part.particles != nullptr ? &part.particles->stencils() : nullptr;
        output_part.nodal_mass = [&model, &part] { return mass_of_part(model, *part.formulation); };
        view.parts.push_back(output_part);
      }
      if (exact_solution != nullptr && exact_solution->has_stress())
        view.exact_stress = [exact_solution](const dealii::Point<dim> &location, const double time)
        { return exact_solution->stress(location, time); };
      if (exact_solution != nullptr && exact_solution->has_temperature())
        view.exact_temperature =
            [exact_solution](const dealii::Point<dim> &location, const double time)
        { return exact_solution->temperature(location, time); };
    }

    /** Throws InputError where an output does not fit to the model. */
    void check(const Clock &clock)
    {
      for (const auto &output : outputs)
        output->check(view_at(clock));
    }

    /** Throws InputError where an output does not continue what is in the directory. */
    void check_continuation(const Clock &clock, const OutputDirectory &directory,
                            const UnitLabels &unit_labels)
    {
      for (const auto &output : outputs)
        output->check_continuation(view_at(clock), directory, unit_labels);
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
    void write(const Clock &clock, TimeTable &statistics, Log &log)
    {
      for (const auto &output : outputs)
      {
        output->write(view_at(clock), statistics);
        if (const std::string report = output->report(); !report.empty())
          log.print(report);
      }
    }

    /** What outputs keep. One without state in the checkpoint, since the earlier run did not have
     * it, begins again. */
    Records records;

    void finish(Json &results, Log &log)
    {
      for (const auto &output : outputs)
      {
        output->finish(results);
        if (const std::string report = output->report(); !report.empty())
          log.print(report);
      }
    }

  private:
    const OutputView<dim> &view_at(const Clock &clock)
    {
      view.time = clock.time;
      view.step = clock.step;
      view.time_step = clock.next_step;
      return view;
    }

    std::vector<std::string> names;
    std::vector<std::unique_ptr<Output<dim>>> outputs;
    OutputView<dim> view;
  };
} // namespace tombolo
