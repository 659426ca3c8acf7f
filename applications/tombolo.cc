// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/command_line.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/processor.h>
#include <tombolo/output/summary.h>
#include <tombolo/simulation/results_owner.h>
#include <tombolo/simulation/run_parameters.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <csignal>
#include <iostream>
#include <string>
#include <vector>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: tombolo [options] FILE.prm\n"
      "  --help, --version\n"
      "  --validate                    read the file and its mesh, build no model, say all that is "
      "wrong\n"
      "  --dry-run                     build the model, print the audit and advice, take no step\n"
      "  --print-parameters[=FORMAT[:SECTION]]\n"
      "                                all entries with documentation and values, or those of a "
      "section, as\n"
      "                                prm, json, xml or markdown (without values); without a file "
      "those that\n"
      "                                any file can have\n"
      "  --list-plugins                every registered name, by kind, with its description\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable); without a "
      "value the\n"
      "                                entry is as though the file did not set it\n"
      "  --resume[=CHECKPOINT]         continue from the newest checkpoint of the output "
      "directory, or\n"
      "                                from this file\n"
      "  --overwrite                   replace the results of another parameter file\n"
      "  --quiet                       no progress\n";

  /** What `--print-parameters=FORMAT:SECTION` asks for. */
  struct Listing
  {
    explicit Listing(const CommandLine &command_line)
    {
      const std::string option = "--print-parameters";
      const std::string value = command_line.value(option, "a format: prm, json, xml or markdown");
      const std::size_t colon = value.find(':');
      if (!value.empty())
        format = value.substr(0, colon);
      if (colon != std::string::npos)
        section = value.substr(colon + 1);
      if (format != "prm" && format != "json" && format != "xml" && format != "markdown")
        throw InputError(option + "=" + value +
                         ": allowed is prm, json, xml or markdown, and behind a colon a section, "
                         "as in " +
                         option + "=\"prm:Time step\".");
    }

    std::string format = "prm", section;
  };

  /** One name in each list, so that all sections are declared. */
  void name_one_of_each(Parameters &parameters)
  {
    for (const char *const list :
         {"Parts", "Materials", "Conditions", "Contacts", "Initial conditions", "Processes"})
      parameters.add_override(std::string(list) + " = NAME");
  }

  /** A word of a command, as a shell takes it. */
  std::string shell_word(const std::string &word)
  {
    const std::string harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                 "_-+=:,./@%";
    if (!word.empty() && word.find_first_not_of(harmless) == std::string::npos)
      return word;
    std::string quoted = "'";
    for (const char c : word)
      quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
  }

  /** The command that continues this run from the newest checkpoint of its output directory. */
  std::string command_to_continue(const CommandLine &command_line)
  {
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    std::string command = n_ranks > 1 ? "mpirun -n " + std::to_string(n_ranks) + " " : "";
    command += shell_word(command_line.program()) + " --resume " + shell_word(command_line.file());
    for (const std::string &assignment : command_line.overrides())
      command += " --set " + shell_word(assignment);
    return command;
  }

  template <int dim>
  int simulate(const Parameters &parameters, const CommandLine &command_line, Log &log)
  {
    const bool resumes = command_line.has("--resume");
    const std::string checkpoint =
        resumes
            ? command_line.value("--resume", "the name of a checkpoint. Without =, it takes the "
                                             "newest one of the output directory")
            : "";
    const std::string directory = parameters.section("").get("Output directory");
    if (!command_line.has("--overwrite") && !command_line.has("--dry-run") &&
        !(resumes && is_checkpoint_of(checkpoint, directory, MPI_COMM_WORLD)))
      refuse_results_of_another_file(parameters);
    if (const std::string advice = advice_on_processor(); !advice.empty())
      log.print("Note: " + advice);
    log.print("Tombolo: " + parameters.section("").get("Title"));
    Simulation<dim> simulation(parameters, log, MPI_COMM_WORLD);
    simulation.audit();
    if (resumes)
      simulation.resume(checkpoint);
    if (command_line.has("--dry-run"))
      return 0;
    const RunResult result = simulation.run();
    const std::string advice = simulation.last_checkpoint().empty()
                                   ? ""
                                   : " To continue: " + command_to_continue(command_line) + " (" +
                                         simulation.last_checkpoint() + ")";
    if (result == RunResult::interrupted)
      log.print("Interrupted; the results up to here are complete." + advice);
    else if (result == RunResult::terminated)
      log.print("Terminated; the results up to here are complete." + advice);
    log.print("Results: " + directory + ". To look at them: scripts/report " +
              shell_word(directory) + " (one page), scripts/plot " + shell_word(directory) +
              " (pictures).");
    return result == RunResult::interrupted  ? 128 + SIGINT
           : result == RunResult::terminated ? 128 + SIGTERM
                                             : 0;
  }

  template <int dim>
  int run(Parameters &parameters, const CommandLine &command_line)
  {
    declare_run_parameters<dim>(parameters);
    parameters.assign();
    if (command_line.has("--print-parameters"))
    {
      parameters.refuse_mistakes();
      const Listing listing(command_line);
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        parameters.print(std::cout, listing.format, true, listing.section);
      return 0;
    }
    validate_run<dim>(parameters, MPI_COMM_WORLD);
    std::vector<std::string> remarks;
    if (command_line.has("--validate"))
      remarks = validate_mesh<dim>(parameters, MPI_COMM_WORLD);
    parameters.refuse_mistakes();
    Log log(MPI_COMM_WORLD, command_line.has("--quiet"));
    for (const std::string &note : parameters.renaming_notes())
      log.print("Note: " + note);
    if (!command_line.has("--validate"))
      return simulate<dim>(parameters, command_line, log);
    for (const std::string &remark : remarks)
      log.warn(remark);
    log.print(command_line.file() + ": nothing wrong was found.");
    return 0;
  }

  /** Reads the parameter file and what the command line sets. */
  void read_parameters(const CommandLine &command_line, Parameters &parameters)
  {
    parameters.collect_mistakes();
    if (command_line.has_file() || !command_line.has("--print-parameters"))
      parameters.read_file(command_line.file());
    else
      name_one_of_each(parameters);
    for (const std::string &assignment : command_line.overrides())
      parameters.attempt([&] { parameters.add_override(assignment); });
    // What the file says cannot be judged without its plug-ins, nor in no dimension.
    if (!parameters.attempt([&] { load_plugin_libraries(parameters, MPI_COMM_WORLD); }))
      parameters.refuse_mistakes();
    const std::string dimension = parameters.raw("Dimension", "3");
    if (dimension != "2" && dimension != "3")
    {
      parameters.refuse("Dimension", "allowed is a whole number from 2 to 3.");
      parameters.refuse_mistakes();
    }
  }

  int run(const int argc, char **argv)
  {
    const CommandLine command_line(argc, argv,
                                   {"--help", "--version", "--validate", "--dry-run",
                                    "--list-plugins", "--quiet", "--overwrite"},
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
      Listing listing(command_line); // refused before the file is read
    Parameters parameters(MPI_COMM_WORLD);
    if (command_line.has_file() || !lists_plugins)
      read_parameters(command_line, parameters);
    if (lists_plugins)
    {
      if (prints)
        for (const PluginDescription &plugin : list_plugins())
          std::cout << plugin.kind << ": " << plugin.name << " - " << plugin.description << "\n";
      return 0;
    }
    return parameters.raw("Dimension", "3") == "2" ? run<2>(parameters, command_line)
                                                   : run<3>(parameters, command_line);
  }
} // namespace

int main(int argc, char **argv)
{
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The run stopped",
      "\nThe outputs written before are complete.");
}
