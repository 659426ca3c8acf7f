#include <tombolo/base/program.h>

#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

#include <exception>
#include <iostream>

namespace tombolo
{
  int run_program(int argc, char **argv, const std::function<int()> &run,
                  const std::string &stopped, const std::string &afterwards)
  {
    const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
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
    catch (const std::exception &error)
    {
      std::cerr << "\nError (unexpected): " << error.what() << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 3);
      return 3;
    }
  }
} // namespace tombolo
