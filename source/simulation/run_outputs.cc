// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/run_outputs.h>

#include <tombolo/model/mass_of_part.h>

namespace tombolo
{
  namespace
  {
    template <int dim>
    void print_report(const Output<dim> &output, Log &log)
    {
      const std::string report = output.report();
      if (!report.empty())
        log.print(report);
    }
  } // namespace

  template <int dim>
  RunOutputs<dim>::RunOutputs(const Section &section)
      : names(output_names<dim>(section)), outputs(create_outputs<dim>(section))
  {
    for (std::size_t i = 0; i < outputs.size(); ++i)
      records.group(names[i], outputs[i]->records).optional();
  }

  template <int dim>
  void RunOutputs<dim>::attach(const Model<dim> &model, const ExactSolution<dim> *exact_solution)
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
      view.exact_stress = [exact_solution](const Point<dim> &location, const double time)
      { return exact_solution->stress(location, time); };
    if (exact_solution != nullptr && exact_solution->has_temperature())
      view.exact_temperature = [exact_solution](const Point<dim> &location, const double time)
      { return exact_solution->temperature(location, time); };
  }

  template <int dim>
  const OutputView<dim> &RunOutputs<dim>::view_at(const Clock &clock)
  {
    view.time = clock.time;
    view.step = clock.step;
    view.time_step = clock.next_step;
    return view;
  }

  template <int dim>
  void RunOutputs<dim>::write(const Clock &clock, TimeTable &statistics, Log &log)
  {
    for (const auto &output : outputs)
    {
      output->write(view_at(clock), statistics);
      print_report(*output, log);
    }
  }

  template <int dim>
  void RunOutputs<dim>::finish(Json &results, Log &log)
  {
    for (const auto &output : outputs)
    {
      output->finish(results);
      print_report(*output, log);
    }
  }

  template class RunOutputs<2>;
  template class RunOutputs<3>;
} // namespace tombolo
