#include <tombolo/base/program.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/memory.h>

#include <deal.II/base/mpi.h>

#include <hdf5.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <new>

namespace tombolo
{
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
  } // namespace

  int run_program(int argc, char **argv, const std::function<int()> &run,
                  const std::string &stopped, const std::string &afterwards)
  {
    begin_hdf5();
    const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
    ignore_signals_of_writes(); // MPI sets its own
    const bool prints = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    try
    {
      return run();
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
        std::cerr << "\n" << stopped << ": " << error.what() << afterwards << std::endl;
      return 2;
    }
    catch (const std::bad_alloc &)
    {
      std::cerr
          << "\nError: The memory is exhausted (" << free_memory() / 1e6
          << " MB are left). Choose fewer cells, a smaller `Dilation` of particles, or a machine "
             "or a limit with more memory."
          << std::endl;
      if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
        MPI_Abort(MPI_COMM_WORLD, 1); // the others do not know
      return 1;
    }
    catch (const std::exception &error)
    {
      std::cerr << "\nError (unexpected): " << error.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 3);
      return 3;
    }
  }
} // namespace tombolo
