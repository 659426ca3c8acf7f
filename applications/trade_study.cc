// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/command_line.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/study/child_process.h>
#include <tombolo/study/trade_study.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <string>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: trade_study [options] FILE.prm\n"
      "Makes the runs of a study with tombolo and tells what their accuracy costs.\n"
      "  --help\n"
      "  --validate                    read the file, make no run, say what is wrong\n"
      "  --list                        print the runs, make none\n"
      "  --print-parameters            all entries with documentation and values\n"
      "  --anew                        make also the runs that were made before\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable)\n"
      "Exit code: 0, or 1 if the study cannot be run, or 2 if a run crashed or took too long.\n";

  /** tombolo in the directory of this program. */
  std::string program_beside()
  {
    return std::filesystem::read_symlink("/proc/self/exe").replace_filename("tombolo").string();
  }

  int run(const int argc, char **argv)
  {
    const CommandLine command_line(
        argc, argv, {"--help", "--validate", "--list", "--print-parameters", "--anew"});
    if (command_line.has("--help"))
    {
      std::cout << help;
      return 0;
    }
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      throw InputError("trade_study runs alone and starts its runs on the ranks that the entry "
                       "\"Ranks\" says.");
    Parameters parameters(MPI_COMM_WORLD);
    parameters.collect_mistakes();
    parameters.read_file(command_line.file());
    for (const std::string &assignment : command_line.overrides())
      parameters.attempt([&] { parameters.add_override(assignment); });
    StudySettings::declare_parameters(parameters);
    parameters.assign();
    parameters.refuse_mistakes();
    if (command_line.has("--print-parameters"))
    {
      parameters.print(std::cout, "prm", true);
      return 0;
    }
    TradeStudy study(parameters, program_beside());
    const Section root = parameters.section("");
    const std::string output_directory = root.get("Output directory");
    parameters.refuse_unused();

    Log log(MPI_COMM_WORLD);
    for (const std::string &note : parameters.renaming_notes())
      log.print("Note: " + note);
    if (command_line.has("--list"))
      for (const StudyRun &run : study.runs())
        log.print(run.label);
    if (command_line.has("--validate"))
      log.print(command_line.file() + ": nothing wrong was found, " +
                std::to_string(study.n_runs()) + " runs.");
    if (command_line.has("--list") || command_line.has("--validate"))
      return 0;
    const OutputDirectory directory(root, "Output directory", MPI_COMM_WORLD);
    log.open_file(directory);
    log.print("Trade study: " + study.settings().title);
    directory.write_parameters(parameters);
    for (const int signal : {SIGINT, SIGTERM})
      std::signal(signal, [](int) { TradeStudy::interrupt(); });
    try
    {
      study.run(log, directory, command_line.has("--anew"));
    }
    catch (const StudyInterrupted &)
    {
      log.print("Interrupted; runs that have ended are kept: the same command goes on.");
      return 128 + SIGINT;
    }
    const auto n_bad =
        std::count_if(study.runs().begin(), study.runs().end(),
                      [](const StudyRun &run) { return run.state >= RunState::timed_out; });
    if (n_bad > 0)
      log.warn(std::to_string(n_bad) + " runs crashed or took too long.");
    return n_bad > 0 ? 2 : 0;
  }
} // namespace

int main(int argc, char **argv)
{
  ChildProcess::remember_environment();
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The study stopped");
}
