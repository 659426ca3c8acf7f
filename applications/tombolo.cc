// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/command_line.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/processor.h>
#include <tombolo/output/summary.h>
#include <tombolo/simulation/run_parameters.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <csignal>
#include <iostream>
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
  int run(Parameters &parameters, const CommandLine &command_line)
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
    if (const std::string advice = advice_on_processor(); !advice.empty())
      log.print("Note: " + advice);
    log.print("Tombolo: " + parameters.section("").get("Title"));
    Simulation<dim> simulation(parameters, log, MPI_COMM_WORLD);
    simulation.audit();
    if (command_line.has("--resume"))
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
    const std::string dimension = parameters.raw("Dimension", "3");
    return dimension == "2" ? run<2>(parameters, command_line) : run<3>(parameters, command_line);
  }
} // namespace

int main(int argc, char **argv)
{
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The run stopped",
      "\nThe outputs written before are complete.");
}
