// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_state.h>

#include <mpi.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** Throws InputError where bodies overlap at the start: the slave node (owned) with the number k
   * in @p slave_nodes is depths[k] deep in the master [L]. Names the deepest of all ranks.
   * Collective. */
  template <int dim>
  void refuse_overlap(const Section &section, const Nodes<dim> &nodes, const NodalState &state,
                      const std::vector<unsigned int> &slave_nodes,
                      const std::vector<double> &depths);

  /** Throws the InputError that tied bodies are apart, with the distance of the nearest of these
   * owned nodes. Collective. */
  template <int dim>
  [[noreturn]] void refuse_distance(const Section &section, const NodalState &state,
                                    const std::vector<unsigned int> &slave_nodes,
                                    const std::vector<unsigned int> &master_nodes,
                                    MPI_Comm communicator);

  /** How many of these owned slave nodes are tied, those with an area, how many are not, and where
   * the first of the others is, by x, y and z. The same on all ranks. Collective. */
  template <int dim>
  std::string describe_tie(const NodalVector &position,
                           const std::vector<unsigned int> &slave_nodes,
                           const std::vector<double> &areas, MPI_Comm communicator);
} // namespace tombolo
