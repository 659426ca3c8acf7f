// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/part.h>

#include <deal.II/base/mpi.h>

#include <array>

namespace tombolo
{
  /** The least and the largest spacing V^(1/dim) of the initial volumes of cells, or of
   * particles, of a part; the first is larger where there are none. Collective. */
  template <int dim>
  std::array<double, 2> spacings_of(const Part<dim> &part, MPI_Comm communicator);
} // namespace tombolo
