// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** The line from a node on the surface of the body through the two next nodes inside, along the
   * edges of two cells of a part. */
  struct SurfaceFibre
  {
    std::array<dealii::types::global_dof_index, 3> node; ///< from the surface inwards
    double volume; ///< that the cell at the surface has around the first node [L^dim]
    double length; ///< of its edge between the first two nodes [L]
  };

  /** Of the part of @p setup, with linear cells: those of the cells that this rank owns. Fibres of
   * parts that are one cell thin are left out. */
  template <int dim>
  std::vector<SurfaceFibre> find_surface_fibres(const PartSetup<dim> &setup);
} // namespace tombolo
