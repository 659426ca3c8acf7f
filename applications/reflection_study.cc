#include <tombolo/base/exceptions.h>
#include <tombolo/base/parameters.h>
#include <tombolo/base/plugin_library.h>
#include <tombolo/output/log.h>
#include <tombolo/output/output_directory.h>
#include <tombolo/simulation/reflection_study.h>

#include <deal.II/base/mpi.h>

#include <exception>
#include <iostream>
#include <string>
#include <vector>

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

  struct Options
  {
    std::string file;
    std::vector<std::string> overrides;
    bool help = false, validate = false, print_parameters = false;
  };

  Options read_options(const int argc, char **argv)
  {
    Options options;
    for (int i = 1; i < argc; ++i)
    {
      const std::string argument = argv[i];
      if (argument == "--help")
        options.help = true;
      else if (argument == "--validate")
        options.validate = true;
      else if (argument == "--print-parameters")
        options.print_parameters = true;
      else if (argument == "--set")
      {
        if (i + 1 == argc)
          throw InputError("--set needs an argument: --set \"Section/Entry = value\".");
        options.overrides.push_back(argv[++i]);
      }
      else if (!argument.empty() && argument[0] == '-')
        throw InputError("Unknown option " + argument + ". See --help.");
      else if (options.file.empty())
        options.file = argument;
      else
        throw InputError("Two parameter files: " + options.file + " and " + argument +
                         ". One study takes one.");
    }
    if (options.file.empty() && !options.help)
      throw InputError("No parameter file given. See --help.");
    return options;
  }

  void run(const int argc, char **argv)
  {
    const Options options = read_options(argc, argv);
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (options.help)
    {
      if (prints)
        std::cout << help;
      return;
    }
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_file(options.file);
    for (const std::string &assignment : options.overrides)
      parameters.add_override(assignment);
    load_plugin_libraries(parameters, MPI_COMM_WORLD);
    ReflectionStudy::declare_parameters(parameters);
    parameters.assign();
    if (options.print_parameters)
    {
      if (prints)
        parameters.print(std::cout, "prm", true);
      return;
    }
    ReflectionStudy study(parameters, MPI_COMM_WORLD);
    const Section root = parameters.section("");
    const std::string title = root.get("Title");
    const std::string output_directory = root.get("Output directory");
    parameters.refuse_unused();

    Log log(MPI_COMM_WORLD);
    if (options.validate)
    {
      log.print(options.file + ": nothing wrong was found.");
      return;
    }
    const OutputDirectory directory(root, "Output directory", MPI_COMM_WORLD);
    directory.remove_earlier_results();
    log.open_file(directory);
    log.print("Reflection study: " + title);
    directory.write_parameters(parameters);
    study.run(log, directory);
  }
} // namespace

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try
  {
    run(argc, argv);
    return 0;
  }
  catch (const InputError &error)
  {
    if (prints)
      std::cerr << "\nError: " << error.what() << std::endl;
    return 1;
  }
  catch (const RunError &error)
  {
    if (prints)
      std::cerr << "\nThe study stopped: " << error.what() << std::endl;
    return 2;
  }
  catch (const std::exception &error)
  {
    std::cerr << "\nError (unexpected): " << error.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 3);
    return 3;
  }
}
