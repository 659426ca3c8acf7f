// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/simulation/simulation.h>

#include <tombolo/base/output_directory.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/mesh/part_cells.h>
#include <tombolo/model/checkpoint.h>
#include <tombolo/model/model_input.h>
#include <tombolo/output/exact_solution.h>
#include <tombolo/output/output.h>
#include <tombolo/output/output_schedule.h>
#include <tombolo/output/unit_labels.h>
#include <tombolo/physics/mechanics/step_size.h>
#include <tombolo/physics/statics/static_steps.h>
#include <tombolo/simulation/initial_state.h>

#include <utility>

namespace tombolo
{
  template <int dim>
  void declare_run_parameters(Parameters &parameters)
  {
    declare_model<dim>(parameters);
    const Entries e(parameters.handler());
    e.number("End time", mandatory, any_number(), "T",
             "The run ends at this time; it starts at 0.");
    e.number("Largest energy error", "0.05", at_least(0.), "",
             "The run stops where the energy balance is off by more than this fraction of the "
             "largest energy so far that was there at the start and came in since, as it is when "
             "the motion is not stable. The check is made at every row of the statistics and every "
             "100 steps; 0 is no limit.");
    e.text("Output directory", "output", "",
           "Where the run leaves its results; made if it does not exist.");
    declare<UnitLabels>(e);
    declare<typename StaticSteps<dim>::Settings>(e);
    InitialState<dim>::declare_parameters(e);
    e.text(
        "Stages", "", "",
        "Names of runs, one after the other, each with a section `Stage: NAME` of entries and "
        "sections in place of those of the file. Each starts from the state at the end of the one "
        "before and leaves its results in a directory of its name within `Output directory`.");
    declare<StepSize<dim>>(e.subsection("Time step"));
    OutputSchedule::declare_parameters(e.subsection("Output"));
    declare_outputs<dim>(e.subsection("Output"));
    declare<ExactSolution<dim>>(e.subsection("Exact solution"));
    declare<Checkpoints>(e.subsection("Checkpoint"));
  }

  template <int dim>
  void validate_run(const Parameters &parameters, const MPI_Comm communicator)
  {
    double end_time = 1.;
    const bool has_end =
        parameters.attempt([&] { end_time = parameters.section("").get_positive("End time"); });
    parameters.attempt(
        [&]
        {
          const std::string directory = parameters.section("").get("Output directory");
          const std::string obstacle =
              from_first_rank(communicator, [&] { return what_prevents_directory(directory); });
          if (!obstacle.empty())
            parameters.fail("Output directory", obstacle);
        });
    const Physics<dim> physics = validate_model<dim>(parameters);
    const bool has_statics = StaticSteps<dim>::are_chosen(parameters);
    if (has_statics)
      parameters.attempt(
          [&]
          {
            if (!physics.has_mechanics)
              parameters.fail("Time integration",
                              "the scene has no mechanics, since its materials have no stresses; "
                              "allowed is `explicit`.");
            typename StaticSteps<dim>::Settings settings(parameters.section(""));
          });
    else if (physics.has_mechanics)
      parameters.attempt([&] { StepSize<dim> step_size(parameters.section("Time step")); });
    parameters.attempt([&] { InitialState<dim>::validate(parameters); });
    if (has_end)
      parameters.attempt([&]
                         { OutputSchedule schedule(parameters.section("Output"), 0., end_time); });
    parameters.attempt([&] { UnitLabels labels(parameters.section("")); });
    parameters.attempt([&] { TableFormat format(parameters.section("Output")); });
    parameters.attempt(
        [&]
        {
          ExactSolution<dim>::validate(parameters.section("Exact solution"), physics.has_mechanics,
                                       physics.has_heat);
        });
    parameters.attempt([&] { create_outputs<dim>(parameters.section("Output")); });
    parameters.attempt([&] { Checkpoints checkpoints(parameters.section("Checkpoint")); });
    for (const char *entry :
         {"Title", "Dimension", "Stages", "Plugin libraries", "Largest energy error"})
      parameters.section("").get(entry);
    parameters.refuse_unused();
  }

  template <int dim>
  std::vector<std::string> validate_mesh(const Parameters &parameters, const MPI_Comm communicator)
  {
    Mesh<dim> mesh(communicator);
    if (!parameters.attempt([&] { read_mesh(parameters.section("Mesh"), mesh, communicator); }))
      return {};
    const std::vector<Section> parts = named_sections(parameters, "Parts", "Part");
    bool are_known =
        parameters.attempt([&] { parameters.section("").get("Parts"); }) && !parts.empty();
    for (const Section &part : parts)
      are_known = parameters.attempt([&] { PartCells<dim>({part}, mesh); }) && are_known;
    if (are_known)
      parameters.attempt([&] { PartCells<dim>(parts, mesh).check(mesh.triangulation); });
    for (const auto &[list, prefix] :
         {std::pair{"Conditions", "Condition"}, std::pair{"Contacts", "Contact"}})
      for (const Section &section : named_sections(parameters, list, prefix))
        if (section.is_set("Boundary"))
          parameters.attempt([&] { boundary_ids(mesh, section, "Boundary"); });
    return mesh.remarks;
  }

  template void declare_run_parameters<2>(Parameters &);
  template void declare_run_parameters<3>(Parameters &);
  template void validate_run<2>(const Parameters &, MPI_Comm);
  template void validate_run<3>(const Parameters &, MPI_Comm);
  template std::vector<std::string> validate_mesh<2>(const Parameters &, MPI_Comm);
  template std::vector<std::string> validate_mesh<3>(const Parameters &, MPI_Comm);
} // namespace tombolo
