// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/plugin_library.h>
#include <tombolo/base/input/program.h>
#include <tombolo/base/log.h>
#include <tombolo/base/output_directory.h>
#include <tombolo/study/waves/reflection_study.h>

#include <deal.II/base/mpi.h>

#include <iostream>
#include <string>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: reflection_study [options] FILE.prm\n"
      "Sends tone bursts at interfaces of finite elements and particles, and tells what returns.\n"
      "  --help\n"
      "  --validate                    read the file, compute nothing, say what is wrong\n"
      "  --print-parameters            all entries with documentation and values\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable)\n";

  int run(const int argc, char **argv)
  {
    const CommandLine command_line(argc, argv, {"--help", "--validate", "--print-parameters"});
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (command_line.has("--help"))
    {
      if (prints)
        std::cout << help;
      return 0;
    }
    Parameters parameters(MPI_COMM_WORLD);
    parameters.collect_mistakes();
    parameters.read_file(command_line.file());
    for (const std::string &assignment : command_line.overrides())
      parameters.attempt([&] { parameters.add_override(assignment); });
    load_plugin_libraries(parameters, MPI_COMM_WORLD);
    ReflectionStudy::declare_parameters(parameters);
    parameters.assign();
    parameters.refuse_mistakes();
    if (command_line.has("--print-parameters"))
    {
      if (prints)
        parameters.print(std::cout, "prm", true);
      return 0;
    }
    ReflectionStudy study(parameters, MPI_COMM_WORLD);
    const Section root = parameters.section("");
    const std::string title = root.get("Title");
    const std::string output_directory = root.get("Output directory");
    parameters.refuse_unused();

    Log log(MPI_COMM_WORLD);
    if (command_line.has("--validate"))
    {
      log.print(command_line.file() + ": nothing wrong was found.");
      return 0;
    }
    const OutputDirectory directory(root, "Output directory", MPI_COMM_WORLD);
    directory.remove_earlier_results();
    log.open_file(directory);
    log.print("Reflection study: " + title);
    directory.write_parameters(parameters);
    study.run(log, directory);
    return 0;
  }
} // namespace

int main(int argc, char **argv)
{
  return run_program(
      argc, argv, [&]() { return run(argc, argv); }, "The study stopped");
}
