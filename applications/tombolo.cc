// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/command_line.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/output/summary.h>
#include <tombolo/simulation/run_parameters.h>
#include <tombolo/simulation/simulation.h>
#include <tombolo/simulation/stages.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <csignal>
#include <iostream>
#include <memory>
#include <string>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: tombolo [options] FILE.prm\n"
      "  --help, --version\n"
      "  --validate                    read the file, build nothing, say what is wrong\n"
      "  --dry-run                     build the model, print the audit, take no step\n"
      "  --print-parameters[=prm|json|xml|markdown]\n"
      "                                all entries with documentation and values; as markdown, a "
      "page\n"
      "                                of all declarations without values\n"
      "  --list-plugins                every registered name, by kind, with its description\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable)\n"
      "  --resume[=CHECKPOINT]         continue from the newest checkpoint of the output "
      "directory, or\n"
      "                                from this file\n"
      "  --quiet                       no progress\n";

  std::string print_format(const CommandLine &command_line)
  {
    const std::string option = "--print-parameters";
    const std::string format = command_line.value(option, "a format: prm, json, xml or markdown");
    if (!format.empty() && format != "prm" && format != "json" && format != "xml" &&
        format != "markdown")
      throw InputError(option + "=" + format + ": allowed is prm, json, xml or markdown.");
    return format.empty() ? "prm" : format;
  }

  template <int dim>
  int run(Parameters &parameters, const CommandLine &command_line, const bool resumes)
  {
    declare_run_parameters<dim>(parameters);
    parameters.assign();
    if (command_line.has("--print-parameters"))
    {
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        parameters.print(std::cout, print_format(command_line), true);
      return 0;
    }
    Log log(MPI_COMM_WORLD, command_line.has("--quiet"));
    for (const std::string &note : parameters.renaming_notes())
      log.print("Note: " + note);
    if (command_line.has("--validate"))
    {
      validate_run<dim>(parameters, MPI_COMM_WORLD);
      log.print(command_line.file() + ": nothing wrong was found.");
      return 0;
    }
    log.print("Tombolo: " + parameters.section("").get("Title"));
    Simulation<dim> simulation(parameters, log, MPI_COMM_WORLD);
    simulation.audit();
    if (resumes)
      simulation.resume(command_line.value("--resume", "the name of a checkpoint. Without =, it "
                                                       "takes the newest one of the output "
                                                       "directory"));
    if (command_line.has("--dry-run"))
      return 0;
    const RunResult result = simulation.run();
    const std::string advice = simulation.last_checkpoint().empty()
                                   ? ""
                                   : " To continue: tombolo --resume " + command_line.file() +
                                         " (" + simulation.last_checkpoint() + ")";
    switch (result)
    {
    case RunResult::interrupted:
      log.print("Interrupted; the results up to here are complete." + advice);
      return 128 + SIGINT;
    case RunResult::terminated:
      log.print("Terminated; the results up to here are complete." + advice);
      return 128 + SIGTERM;
    default:
      return 0;
    }
  }

  int run_of_dimension(Parameters &parameters, const CommandLine &command_line, const bool resumes)
  {
    const std::string dimension = parameters.raw("Dimension", "3");
    return dimension == "2" ? run<2>(parameters, command_line, resumes)
                            : run<3>(parameters, command_line, resumes);
  }

  std::unique_ptr<Parameters> parameters_of(const Stages &stages, const std::size_t stage,
                                            const CommandLine &command_line)
  {
    auto parameters = stages.parameters(stage, command_line.overrides());
    load_plugin_libraries(*parameters, MPI_COMM_WORLD);
    return parameters;
  }

  template <int dim>
  void validate(Parameters &parameters)
  {
    declare_run_parameters<dim>(parameters);
    parameters.assign();
    validate_run<dim>(parameters, MPI_COMM_WORLD);
  }

  /** The runs of a file with `Stages`. All are validated before the first begins; a resumed chain
   * goes on with the first that has not come to its end. */
  int run_stages(const Stages &stages, const CommandLine &command_line)
  {
    const std::size_t n_stages = stages.names().size();
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    const bool only_looks = command_line.has("--print-parameters") ||
                            command_line.has("--validate") || command_line.has("--dry-run");
    bool resumes = command_line.has("--resume");
    if (resumes && !command_line.value("--resume", "").empty())
      throw InputError("--resume=CHECKPOINT: a chain of stages goes on where it was ended; allowed "
                       "is --resume without a checkpoint.");
    if (!only_looks)
      for (std::size_t stage = 0; stage < n_stages; ++stage)
      {
        const auto parameters = parameters_of(stages, stage, command_line);
        parameters->raw("Dimension", "3") == "2" ? validate<2>(*parameters)
                                                 : validate<3>(*parameters);
      }
    for (std::size_t stage = 0; stage < n_stages; ++stage)
    {
      if (command_line.has("--dry-run") && stage > 0)
        break; // its state is not there yet
      const std::string directory = stages.output_directory(stage, command_line.overrides());
      const bool is_last = stage + 1 == n_stages;
      if (resumes && !is_last && has_finished(directory, MPI_COMM_WORLD))
        continue;
      if (prints && !command_line.has("--quiet"))
        std::cout << "# Stage: " << stages.names()[stage] << std::endl;
      const auto parameters = parameters_of(stages, stage, command_line);
      // Of a stage that has not begun, or has left no checkpoint, nothing can be resumed.
      const bool has_checkpoint = resumes && has_checkpoints(directory, MPI_COMM_WORLD);
      const int result = run_of_dimension(*parameters, command_line, has_checkpoint);
      if (result != 0)
        return result;
      resumes = false;
    }
    return 0;
  }

  int run(const int argc, char **argv)
  {
    const CommandLine command_line(
        argc, argv, {"--help", "--version", "--validate", "--dry-run", "--list-plugins", "--quiet"},
        {"--print-parameters", "--resume"});
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (command_line.has("--help") || command_line.has("--version"))
    {
      if (prints)
        std::cout << (command_line.has("--help") ? help : json_text(version_information()) + "\n");
      return 0;
    }
    const bool lists_plugins = command_line.has("--list-plugins");
    if (command_line.has("--print-parameters"))
      print_format(command_line); // refused before the file is read
    Parameters parameters(MPI_COMM_WORLD);
    if (command_line.has_file() || !lists_plugins)
    {
      parameters.read_file(command_line.file());
      for (const std::string &assignment : command_line.overrides())
        parameters.add_override(assignment);
      load_plugin_libraries(parameters, MPI_COMM_WORLD);
    }
    if (lists_plugins)
    {
      if (prints)
        for (const PluginDescription &plugin : list_plugins())
          std::cout << plugin.kind << ": " << plugin.name << " - " << plugin.description << "\n";
      return 0;
    }
    if (!parameters.raw("Stages").empty())
      return run_stages(Stages(command_line.file(), MPI_COMM_WORLD), command_line);
    return run_of_dimension(parameters, command_line, command_line.has("--resume"));
  }
} // namespace

int main(int argc, char **argv)
{
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The run stopped",
      "\nThe outputs written before are complete.");
}
