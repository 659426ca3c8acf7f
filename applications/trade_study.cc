#include <tombolo/base/exceptions.h>
#include <tombolo/base/parameters.h>
#include <tombolo/output/log.h>
#include <tombolo/output/output_directory.h>
#include <tombolo/study/child_process.h>
#include <tombolo/study/trade_study.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

using namespace tombolo;

namespace
{
  const char *const help =
      "Usage: trade_study [options] FILE.prm\n"
      "Runs tombolo on the members of a study and tells what their accuracy costs.\n"
      "  --help\n"
      "  --validate                    read the file, run nothing, say what is wrong\n"
      "  --list                        print the members, run nothing\n"
      "  --print-parameters            all entries with documentation and values\n"
      "  --anew                        run also the members that have run before\n"
      "  --set \"Section/Entry = value\"  override from the command line (repeatable)\n"
      "Exit code: 0, or 1 if the study cannot be run, or 2 if a member crashed or took too long.\n";

  struct Options
  {
    std::string file;
    std::vector<std::string> overrides;
    bool help = false, validate = false, list = false, print_parameters = false, anew = false;
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
      else if (argument == "--list")
        options.list = true;
      else if (argument == "--anew")
        options.anew = true;
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

  /** tombolo in the directory of this program. */
  std::string program_beside()
  {
    return std::filesystem::read_symlink("/proc/self/exe").replace_filename("tombolo").string();
  }

  int run(const int argc, char **argv)
  {
    const Options options = read_options(argc, argv);
    if (options.help)
    {
      std::cout << help;
      return 0;
    }
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      throw InputError("trade_study runs alone and starts its members on the ranks that the entry "
                       "\"Ranks\" says.");
    Parameters parameters(MPI_COMM_WORLD);
    parameters.read_file(options.file);
    for (const std::string &assignment : options.overrides)
      parameters.add_override(assignment);
    StudySettings::declare_parameters(parameters);
    parameters.assign();
    if (options.print_parameters)
    {
      parameters.print(std::cout, "prm", true);
      return 0;
    }
    TradeStudy study(parameters, program_beside());
    const Section root = parameters.section("");
    const std::string output_directory = root.get("Output directory");
    parameters.refuse_unused();

    Log log(MPI_COMM_WORLD);
    if (options.list)
      for (const StudyMember &member : study.members())
        log.print(member.label);
    if (options.validate)
      log.print(options.file + ": nothing wrong was found, " + std::to_string(study.n_members()) +
                " members.");
    if (options.list || options.validate)
      return 0;
    const OutputDirectory directory(root, "Output directory", MPI_COMM_WORLD);
    log.open_file(directory);
    log.print("Trade study: " + study.settings().title);
    directory.write_parameters(parameters);
    for (const int signal : {SIGINT, SIGTERM})
      std::signal(signal, [](int) { TradeStudy::interrupt(); });
    study.run(log, directory, options.anew);
    const auto n_bad = std::count_if(study.members().begin(), study.members().end(),
                                     [](const StudyMember &member)
                                     { return member.state >= MemberState::timed_out; });
    if (n_bad > 0)
      log.warn(std::to_string(n_bad) + " members crashed or took too long.");
    return n_bad > 0 ? 2 : 0;
  }
} // namespace

int main(int argc, char **argv)
{
  ChildProcess::remember_environment();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  try
  {
    return run(argc, argv);
  }
  catch (const StudyInterrupted &)
  {
    std::cerr << "\nInterrupted; members that have run are kept: the same command goes on."
              << std::endl;
    return 130;
  }
  catch (const InputError &error)
  {
    std::cerr << "\nError: " << error.what() << std::endl;
    return 1;
  }
  catch (const std::exception &error)
  {
    std::cerr << "\nThe study stopped: " << error.what() << std::endl;
    return 2;
  }
}
