// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <string>

#include "mock_scene.h"

namespace
{
  template <int dim>
  void write(const unsigned int degree, const double first_x, const bool one_cell,
             const std::string &path)
  {
    const mock::Model<dim> model(degree, first_x, one_cell);
    const tombolo::OutputDirectory directory(path, MPI_COMM_WORLD);
    tombolo::TimeTable statistics("statistics.csv", tombolo::TimeTable::Rows::in_memory);
    mock::OutputsOf<dim> outputs("subsection visualization\n set Precision = " +
                                 std::string(degree == 1 ? "double" : "single") + "\nend\n");
    for (const auto &output : outputs.outputs)
      output->start(model.view(0, 0), directory, tombolo::UnitLabels());
    for (const double time : {0., 0.1})
      for (const auto &output : outputs.outputs)
        output->write(model.view(time, 0), statistics);
  }
} // namespace

/** Writes the solution of the mock scene: DIMENSION DEGREE FIRST_X all|one DIRECTORY. */
int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const auto write_in_dimension = std::string(argv[1]) == "2" ? &write<2> : &write<3>;
  write_in_dimension(static_cast<unsigned int>(std::stoul(argv[2])), std::stod(argv[3]),
                     std::string(argv[4]) == "one", argv[5]);
}
