// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/formulation.h>

#include <deal.II/base/types.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** The line from a node on the surface of the body through the next nodes inside, along the edges
   * of cells of a part. */
  struct SurfaceFibre
  {
    static constexpr unsigned int most_nodes = 5, least_nodes = 3;

    /** From the surface inwards. */
    std::array<dealii::types::global_dof_index, most_nodes> node;
    unsigned int n_nodes; ///< most_nodes, or least_nodes where there are fewer
    double volume;        ///< that the cell at the surface has around the first node [L^dim]
    double length;        ///< of its edge between the first two nodes [L]
  };

  /** Of the part of @p setup, with linear cells: those of the cells at the surface that this rank
   * owns; nodes further inside may be known to other ranks only. A line ends where the part does,
   * at the next surface, and where cells of another size begin. Those that have fewer than
   * least_nodes are left out. Collective. */
  template <int dim>
  std::vector<SurfaceFibre> find_surface_fibres(const PartSetup<dim> &setup);
} // namespace tombolo
