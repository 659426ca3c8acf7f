// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/config.h>

#include <mpi.h>

namespace tombolo
{
  /** The communicator of a triangulation or of a DoFHandler, whose name depends on the version of
   * deal.II. */
  template <class Mesh>
  MPI_Comm communicator_of(const Mesh &mesh)
  {
#if DEAL_II_VERSION_GTE(9, 7, 0)
    return mesh.get_mpi_communicator();
#else
    return mesh.get_communicator();
#endif
  }
} // namespace tombolo
