// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /**
   * Places for inner nodes that are to the present positions of all other nodes as in the lattice
   * of the start: the displacement from the lattice is harmonic there, with the functions of
   * CellSimplices. So a lattice that was deformed affinely stays what it is, whatever its grading.
   *
   * @p nodes and @p lattice: local numbers and initial corners of the cells of the part on this
   * rank; @p is_free (scalar, owned nodes): positive where a node is placed anew; @p position gets
   * the places, with current ghosts. @p initial: initial positions. Collective.
   */
  template <int dim>
  void
  place_inner_nodes(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
                    const std::vector<typename SubCells<dim>::Corners> &lattice,
                    const NodalVector &is_free, const NodalVector &initial, NodalVector &position);

  /**
   * A step of inner nodes towards places at which the initial positions, as functions of the
   * present ones, are harmonic (Winslow). Cells stay apart there where place_inner_nodes() would
   * fold them, above a cavity of the surface. Returns displacements, zero elsewhere.
   *
   * @p lattice: initial corners; @p position: the present ones, of cells that are not turned over,
   * with ghosts. Collective.
   */
  template <int dim>
  NodalVector
  winslow_step(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
               const std::vector<typename SubCells<dim>::Corners> &lattice,
               const NodalVector &is_free, const NodalVector &initial, const NodalVector &position);
} // namespace tombolo
