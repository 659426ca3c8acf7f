// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/state/nodal_vector.h>

namespace tombolo
{
  /** Gives the plastic heat that the points of cells (CellPoints) hold to their nodes, by the shape
   * functions. */
  template <typename Points>
  void add_plastic_heat(Points &points, const PlasticHeating &plastic_heating, NodalVector &heat)
  {
    if (!plastic_heating.has_plastic_heat())
      return;
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      const unsigned int *const nodes = points.cells().nodes(batch);
      for (unsigned int q = 0; q < Points::n_points; ++q)
        for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
        {
          const double given = plastic_heating.give(
              points.material_points(), (batch * Points::n_points + q) * n_lanes + lane);
          for (unsigned int k = 0; k < Points::n_nodes; ++k)
            *heat.node(nodes[k * n_lanes + lane]) += points.shape_value(q, k) * given;
        }
    }
  }
} // namespace tombolo
