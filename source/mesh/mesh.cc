// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/mesh.h>

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
} // namespace tombolo
