// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/mpi.h>

#include <string>

#include "mock_scene.h"

namespace
{
  using namespace tombolo;

  template <int dim>
  void write(const unsigned int degree, const double first_x, const bool one_cell,
             const std::string &path)
  {
    const mock::Model<dim> model(degree, first_x, one_cell);
    const OutputDirectory directory(path, MPI_COMM_WORLD);
    TimeTable statistics("statistics.csv", TimeTable::Rows::in_memory);
    const std::string entries =
        degree == 1
            ? " set Precision = double\n"
              " set Further fields = principal stresses, logarithmic strain, internal fields\n"
            : " set Precision = single\n";
    mock::OutputsOf<dim> outputs("subsection visualization\n" + entries + "end\n");
    Parameters labelled(MPI_COMM_WORLD);
    labelled.read_text("set Unit labels = length: mm, time: ms, stress: MPa\n", "labels.prm");
    declare<UnitLabels>(labelled.handler());
    labelled.assign();
    const UnitLabels labels(labelled.section(""));
    for (const auto &output : outputs.outputs)
      output->start(model.view(0, 0), directory, labels);
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
