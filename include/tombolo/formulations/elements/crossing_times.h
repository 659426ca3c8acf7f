// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/point_stiffness.h>

#include <vector>

namespace tombolo
{
  /** Calls @p use with each batch, its nodal positions and the times that longitudinal waves take
   * through its cells: their lengths over the wave speed, eq. (41) without its factor. */
  template <int dim, typename Element, typename Use>
  void for_crossing_times(const CellPoints<dim, Element> &points,
                          const CellIntegration<dim, Element> &integration,
                          const NodalVector &position, const Use &use)
  {
    using Points = CellPoints<dim, Element>;
    const PointStiffness stiffness(integration.material(), points.material_points(),
                                   StrainMeasure::rate);
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      Lanes volume[Points::n_points];
      integration.find_volumes(points, batch, position, x, volume);

      // Where the moduli are constant the density is not: c grows with √J.
      Lanes total = 0., largest_ratio = 0.;
      for (unsigned int q = 0; q < Points::n_points; ++q)
      {
        total += volume[q];
        largest_ratio =
            max(largest_ratio, stiffness.squared_speed(Points::first_point(batch) + q * n_lanes));
      }
      const Lanes time =
          characteristic_length<dim, Element::degree>(x, total) /
          (integration.material().longitudinal_wave_speed() * square_root(largest_ratio));
      use(batch, x, time);
    }
  }

  /** Formulation::courant_limits() of cells. */
  template <int dim, typename Element>
  void find_crossing_times(const CellPoints<dim, Element> &points,
                           const CellIntegration<dim, Element> &integration,
                           const NodalVector &position, std::vector<double> &time_steps)
  {
    constexpr double of_removed_cells = 1e300;
    const CellBatches<dim> &cells = points.cells();
    time_steps.assign(cells.n_cells(), of_removed_cells);
    for_crossing_times(points, integration, position,
                       [&](const unsigned int batch,
                           const typename CellPoints<dim, Element>::NodeValues &, const Lanes &time)
                       {
                         for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
                           time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
                       });
  }
} // namespace tombolo
