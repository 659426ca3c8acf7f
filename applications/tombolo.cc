#include <tombolo/base/parameters.h>
#include <tombolo/base/plugin_library.h>
#include <tombolo/base/registry.h>
#include <tombolo/output/summary.h>
#include <tombolo/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: tombolo [options] FILE.prm\n"
      "  --help, --version\n"
      "  --validate                    read the file, build nothing, say what is wrong\n"
      "  --dry-run                     build the model, print the audit, take no step\n"
      "  --print-parameters[=prm|json|xml]\n"
      "                                all entries with documentation and values\n"
      "  --list-plugins                every registered name, by kind, with its description\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable)\n"
      "  --resume[=CHECKPOINT]         continue from the newest checkpoint of the output "
      "directory, or\n"
      "                                from this file\n"
      "  --quiet                       no progress\n";

  struct Options
  {
    std::string file;
    std::vector<std::string> overrides;
    std::string print_format;
    bool help = false, version = false, validate = false, dry_run = false, list_plugins = false,
         quiet = false, resume = false;
    std::string checkpoint;
  };

  Options read_options(const int argc, char **argv)
  {
    Options options;
    const std::vector<std::string> known = {
        "--help",         "--version", "--validate", "--dry-run", "--print-parameters",
        "--list-plugins", "--set",     "--quiet",    "--resume"};
    for (int i = 1; i < argc; ++i)
    {
      const std::string argument = argv[i];
      const std::string name = argument.substr(0, argument.find('='));
      if (argument == "--help")
        options.help = true;
      else if (argument == "--version")
        options.version = true;
      else if (argument == "--validate")
        options.validate = true;
      else if (argument == "--dry-run")
        options.dry_run = true;
      else if (argument == "--list-plugins")
        options.list_plugins = true;
      else if (argument == "--quiet")
        options.quiet = true;
      else if (argument == "--set")
      {
        if (i + 1 == argc)
          throw InputError("--set needs an argument: --set \"Section/Entry = value\".");
        options.overrides.push_back(argv[++i]);
      }
      else if (name == "--resume")
      {
        options.resume = true;
        options.checkpoint = argument.substr(std::min(name.size() + 1, argument.size()));
        if (argument.size() == name.size() + 1)
          throw InputError(
              "--resume= needs the name of a checkpoint. Without =, it takes the newest "
              "one of the output directory.");
      }
      else if (name == "--print-parameters")
      {
        options.print_format = argument == name ? "prm" : argument.substr(name.size() + 1);
        if (options.print_format != "prm" && options.print_format != "json" &&
            options.print_format != "xml")
          throw InputError("--print-parameters=" + options.print_format +
                           ": allowed is prm, json or xml.");
      }
      else if (!argument.empty() && argument[0] == '-')
      {
        const std::string nearest = nearest_name(name, known);
        throw InputError("Unknown option " + argument + "." +
                         (nearest.empty() ? "" : " Did you mean " + nearest + "?") +
                         " See --help.");
      }
      else if (options.file.empty())
        options.file = argument;
      else
        throw InputError("Two parameter files: " + options.file + " and " + argument +
                         ". One run takes one.");
    }
    const bool needs_no_file = options.help || options.version || options.list_plugins;
    if (options.file.empty() && !needs_no_file)
      throw InputError("No parameter file given. See --help.");
    return options;
  }

  template <int dim>
  int run(Parameters &parameters, const Options &options)
  {
    Simulation<dim>::declare_parameters(parameters);
    parameters.assign();
    if (!options.print_format.empty())
    {
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        parameters.print(std::cout, options.print_format, true);
      return 0;
    }
    Log log(MPI_COMM_WORLD, options.quiet);
    if (options.validate)
    {
      Simulation<dim>::validate(parameters, MPI_COMM_WORLD);
      log.print(options.file + ": nothing wrong was found.");
      return 0;
    }
    log.print("Tombolo: " + parameters.section("").get("Title"));
    Simulation<dim> simulation(parameters, log, MPI_COMM_WORLD);
    simulation.audit();
    if (options.resume)
      simulation.resume(options.checkpoint);
    if (options.dry_run)
      return 0;
    const RunResult result = simulation.run();
    const std::string advice = simulation.last_checkpoint().empty()
                                   ? ""
                                   : " To continue: tombolo --resume " + options.file + " (" +
                                         simulation.last_checkpoint() + ")";
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
    const Options options = read_options(argc, argv);
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    if (options.help || options.version)
    {
      if (prints)
        std::cout << (options.help ? help : version_information().to_string() + "\n");
      return 0;
    }
    Parameters parameters(MPI_COMM_WORLD);
    if (!options.file.empty())
    {
      parameters.read_file(options.file);
      for (const std::string &assignment : options.overrides)
        parameters.add_override(assignment);
      load_plugin_libraries(parameters, MPI_COMM_WORLD);
    }
    if (options.list_plugins)
    {
      if (prints)
        for (const PluginDescription &plugin : list_plugins())
          std::cout << plugin.kind << ": " << plugin.name << " - " << plugin.description << "\n";
      return 0;
    }
    const std::string dimension = parameters.raw("Dimension", "3");
    return dimension == "2" ? run<2>(parameters, options) : run<3>(parameters, options);
  }
} // namespace

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try
  {
    return run(argc, argv);
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
      std::cerr << "\nThe run stopped: " << error.what()
                << "\nThe outputs written before are complete." << std::endl;
    return 2;
  }
  catch (const std::exception &error)
  {
    // Not agreed among ranks, unlike the others: whoever fails must stop all.
    std::cerr << "\nError (unexpected): " << error.what() << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 3);
    return 3;
  }
}
