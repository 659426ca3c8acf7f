// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/mesh.h>

#include <tombolo/base/memory.h>
#include <tombolo/mesh/face_shapes.h>

#include <deal.II/base/mpi.h>

#include <sstream>

namespace tombolo
{
  // The mesh is rebuilt from its coarse cells at every repartition, so that the order of the cells
  // on a rank depends on what the rank holds and not on what it held before. Cells that meet at a
  // vertex differ by one level at most.
  template <int dim>
  Mesh<dim>::Mesh(MPI_Comm communicator)
      : triangulation(communicator, dealii::Triangulation<dim>::limit_level_difference_at_vertices,
                      dealii::parallel::distributed::Triangulation<
                          dim>::mesh_reconstruction_after_repartitioning)
  {}

  template struct Mesh<2>;
  template struct Mesh<3>;

  void refuse_more_than_memory(const Section &section, const std::string &entry,
                               const double n_coarse_cells, const double n_cells,
                               const MPI_Comm communicator)
  {
    constexpr double bytes_of_coarse_cell = 2000, bytes_of_cell = 1000;
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(communicator, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    const double n_ranks_here = Utilities::MPI::n_mpi_processes(machine);
    MPI_Comm_free(&machine);
    const double needed =
        n_ranks_here * (bytes_of_coarse_cell * n_coarse_cells +
                        bytes_of_cell * n_cells / Utilities::MPI::n_mpi_processes(communicator));
    // Where the machines differ, the one with the least beyond its need decides for all.
    const double lacking = Utilities::MPI::max(needed - free_memory(), communicator);
    if (!(lacking > 0))
      return;
    std::ostringstream message;
    message.precision(3);
    message << "A mesh of " << n_cells << " cells needs more memory than there is: about "
            << needed / 1e6 << " MB at the least, " << lacking / 1e6
            << " MB more than are free here. Choose fewer cells, or a machine or a limit with more "
               "memory.";
    section.fail(entry, message.str());
  }

  template struct FaceShapes<2>;
  template struct FaceShapes<3>;
} // namespace tombolo
