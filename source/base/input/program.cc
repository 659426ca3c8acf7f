// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/program.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/registry.h>
#include <tombolo/base/memory.h>

#include <deal.II/base/mpi.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>

namespace tombolo
{
  CommandLine::CommandLine(const int argc, char **argv, const std::vector<std::string> &flags,
                           const std::vector<std::string> &valued)
      : program_name(argc > 0 ? argv[0] : "")
  {
    std::vector<std::string> known = flags;
    known.insert(known.end(), valued.begin(), valued.end());
    known.emplace_back("--set");
    for (int i = 1; i < argc; ++i)
    {
      const std::string argument = argv[i];
      const std::string name = argument.substr(0, argument.find('='));
      if (argument == "--set")
      {
        if (i + 1 == argc)
          throw InputError("--set needs an argument: --set \"Section/Entry = value\".");
        assignments.emplace_back(argv[++i]);
      }
      else if (std::count(flags.begin(), flags.end(), argument) > 0 ||
               std::count(valued.begin(), valued.end(), name) > 0)
        options[name] = argument.substr(name.size());
      else if (!argument.empty() && argument[0] == '-')
      {
        const std::string nearest = nearest_name(name, known);
        throw InputError("Unknown option " + argument + "." +
                         (nearest.empty() ? "" : " Did you mean " + nearest + "?") +
                         " See --help.");
      }
      else if (file_name.empty())
        file_name = argument;
      else
        throw InputError("Two parameter files: " + file_name + " and " + argument +
                         ". One run takes one.");
    }
  }

  std::string CommandLine::value(const std::string &option, const std::string &what) const
  {
    const std::string &text = options.at(option);
    if (text == "=")
      throw InputError(option + "= needs " + what + ".");
    return text.empty() ? text : text.substr(1);
  }

  const std::string &CommandLine::file() const
  {
    if (file_name.empty())
      throw InputError("No parameter file given. See --help.");
    return file_name;
  }

  namespace
  {
    /** Begun before MPI, HDF5 does not end within MPI_Finalize, where it crashes on a file that
     * could not be closed because the disk is full. */
    void begin_hdf5()
    {
      H5dont_atexit();
      H5open();
    }

    /** A reader of the screen output that goes away, or a limit on the size of files, is an error
     * of a write like others. */
    void ignore_signals_of_writes()
    {
      std::signal(SIGPIPE, SIG_IGN);
      std::signal(SIGXFSZ, SIG_IGN);
    }

    /** In one piece, after what was printed before: mpirun mixes what comes in several. */
    void print_message(const std::string &message)
    {
      std::cout.flush();
      std::cerr << "\n" + message + "\n";
    }
  } // namespace

  int run_program(int argc, char **argv, const std::function<int()> &run,
                  const std::string &stopped, const std::string &afterwards)
  {
    begin_hdf5();
    // PETSc, which deal.II starts too, reports options that it does not know (deal.II 9.6 with
    // PETSc 3.22).
    int n_arguments = std::min(argc, 1);
    const dealii::Utilities::MPI::MPI_InitFinalize mpi(n_arguments, argv, 1);
    ignore_signals_of_writes(); // MPI sets its own
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    try
    {
      return run();
    }
    catch (const InputError &error)
    {
      if (prints)
        print_message(std::string("Error: ") + error.what());
      return 1;
    }
    catch (const RunError &error)
    {
      if (prints)
        print_message(stopped + ": " + error.what() + afterwards);
      return 2;
    }
    catch (const std::bad_alloc &)
    {
      print_message(
          "Error: The memory is exhausted (" + std::to_string(std::lround(free_memory() / 1e6)) +
          " MB are left). Choose fewer cells, a smaller `Dilation` of particles, or a machine or a "
          "limit with more memory.");
      if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
        MPI_Abort(MPI_COMM_WORLD, 1); // the others receive no message
      return 1;
    }
    catch (const std::exception &error)
    {
      print_message(std::string("Error (unexpected): ") + error.what());
    }
    catch (...) // of a plug-in
    {
      print_message("Error (unexpected): what was thrown is no exception, and has no message.");
    }
    MPI_Abort(MPI_COMM_WORLD, 3);
    return 3;
  }
} // namespace tombolo
