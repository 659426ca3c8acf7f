// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/output/summary.h>
#include <tombolo/simulation/results_owner.h>
#include <tombolo/simulation/simulation.h>
#include <tombolo/simulation/stages.h>
#include <tombolo/version.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
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
      "  --overwrite                   replace the results of another parameter file, or of a run "
      "that\n"
      "                                has not come to its end and could be resumed\n"
      "  --quiet                       no progress\n";

  /** The request of `--print-parameters=FORMAT:SECTION`. */
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

  /** A word of a command, quoted for a shell. */
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

  /** A sentence for the user where this processor has wider vectors than the program was compiled
   * for, so that another build can be faster; empty elsewhere. Not collective. */
  std::string advice_on_processor()
  {
#if defined(__x86_64__) && defined(__OPTIMIZE__)
    const std::string architecture = TOMBOLO_ARCHITECTURE;
    std::string wider;
#  ifndef __AVX2__
    if (__builtin_cpu_supports("avx2"))
      wider = "AVX2";
#  endif
#  ifndef __AVX512F__
    if (__builtin_cpu_supports("avx512f"))
      wider = "AVX-512";
#  endif
    if (!wider.empty())
      return "This program is built for " +
             (architecture.empty() ? std::string("every processor of its kind") : architecture) +
             ", and this processor has " + wider +
             ": built from its sources on this machine, it can be faster.";
#endif
    return "";
  }

  /** Whether the scripts are in the directory of the program, as commands. */
  bool is_installed()
  {
    namespace fs = std::filesystem;
    std::error_code code;
    return fs::exists(fs::read_symlink("/proc/self/exe", code).parent_path() / "tombolo-report",
                      code);
  }

  template <int dim>
  int simulate(const Parameters &parameters, const CommandLine &command_line, const bool resumes,
               Log &log)
  {
    const std::string checkpoint =
        resumes
            ? command_line.value("--resume", "the name of a checkpoint. Without =, it takes the "
                                             "newest one of the output directory")
            : "";
    const std::string directory = parameters.section("").get("Output directory");
    if (!command_line.has("--dry-run"))
      refuse_running_run(parameters);
    if (!command_line.has("--overwrite") && !command_line.has("--dry-run") &&
        !(resumes && is_checkpoint_of(checkpoint, directory, MPI_COMM_WORLD)))
    {
      refuse_results_of_another_file(parameters);
      // A chain that is resumed starts its later stages from their beginning.
      if (resumes || !command_line.has("--resume"))
        refuse_unfinished_run(parameters);
    }
    if (const std::string advice = advice_on_processor(); !advice.empty())
      log.print("Note: " + advice);
    log.print("Tombolo: " + parameters.section("").get("Title"));
    const auto simulation = create_simulation<dim>(parameters, log, MPI_COMM_WORLD);
    simulation->audit();
    if (resumes)
      simulation->resume(checkpoint);
    if (command_line.has("--dry-run"))
      return 0;
    const RunResult result = simulation->run();
    const std::string advice = simulation->last_checkpoint().empty()
                                   ? ""
                                   : " To continue: " + command_to_continue(command_line) + " (" +
                                         simulation->last_checkpoint() + ")";
    if (result == RunResult::interrupted)
      log.print("Interrupted; the results up to here are complete." + advice);
    else if (result == RunResult::terminated)
      log.print("Terminated; the results up to here are complete." + advice);
    const std::string scripts = is_installed() ? "tombolo-" : "scripts/";
    log.print("Results: " + directory + ". To look at them: " + scripts + "report " +
              shell_word(directory) + " (one page), " + scripts + "plot " + shell_word(directory) +
              " (pictures).");
    return result == RunResult::interrupted  ? 128 + SIGINT
           : result == RunResult::terminated ? 128 + SIGTERM
                                             : 0;
  }

  template <int dim>
  int run(Parameters &parameters, const CommandLine &command_line, const bool resumes)
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
      return simulate<dim>(parameters, command_line, resumes, log);
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
    // The file cannot be checked without its plug-ins, or without a dimension.
    if (!parameters.attempt([&] { load_plugin_libraries(parameters, MPI_COMM_WORLD); }))
      parameters.refuse_mistakes();
    const std::string dimension = parameters.raw("Dimension", "3");
    if (dimension != "2" && dimension != "3")
    {
      parameters.refuse("Dimension", "allowed is a whole number from 2 to 3.");
      parameters.refuse_mistakes();
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
   * goes on with the first that has not reached its end. */
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
        try
        {
          parameters->raw("Dimension", "3") == "2" ? validate<2>(*parameters)
                                                   : validate<3>(*parameters);
        }
        catch (const InputError &error)
        {
          throw InputError(std::string(error.what()) + " (Stage \"" + stages.names()[stage] +
                           "\".)");
        }
        if (!resumes && !command_line.has("--overwrite"))
          refuse_unfinished_run(*parameters);
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
    for (const std::string &assignment : command_line.overrides())
      Stages::refuse_stages(assignment);
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
