// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** Declares every entry and section of a parameter file of a run. */
  template <int dim>
  void declare_run_parameters(Parameters &parameters);

  /** Reads what can be read without a mesh, and refuses what is wrong with it. Throws InputError.
   * Collective. */
  template <int dim>
  void validate_run(const Parameters &parameters, MPI_Comm communicator);

  /** Reads the mesh, and refuses parts, conditions and contacts that name groups of cells or
   * boundaries which it does not have, and cells that no part, or two, would contain. Builds no
   * model. Returns the remarks of the reader of the mesh. Throws InputError. Collective. */
  template <int dim>
  std::vector<std::string> validate_mesh(const Parameters &parameters, MPI_Comm communicator);
} // namespace tombolo
