// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <mpi.h>

namespace tombolo
{
  /**
   * Refuses, at an entry of a mesh source, a mesh that this machine cannot hold, before anything of
   * it is built: coarse cells take about 2 kB on every rank, and each cell with its nodes and
   * material points about 1 kB on one, which is less than any model needs. Throws InputError.
   * Collective.
   */
  void refuse_more_than_memory(const Section &section, const std::string &entry,
                               double n_coarse_cells, double n_cells, MPI_Comm communicator);
} // namespace tombolo
