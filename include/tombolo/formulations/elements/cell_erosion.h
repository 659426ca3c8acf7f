// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/erosion_criterion.h>

#include <vector>

namespace tombolo
{
  /** The places, ascending, of the cells that fulfil the criterion or whose volume is no longer
   * positive at these positions. Only if the criterion is on. */
  template <int dim, typename Element>
  std::vector<unsigned int> find_failed_places(const CellPoints<dim, Element> &points,
                                               const CellIntegration<dim, Element> &integration,
                                               const ErosionCriterion &erosion,
                                               const NodalVector &position)
  {
    using Points = CellPoints<dim, Element>;
    // A point with more than this part of its initial volume does not lose it in one stable step.
    constexpr double small_volume = 0.5;
    std::vector<unsigned int> failed_places;
    const double *const ratios =
        points.material_points().component(MaterialPoints::volume_ratio, 0);
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      const std::size_t first = Points::first_point(batch);
      Lanes ratio = load_lanes(ratios + first), reaches = 0.;
      for (unsigned int i = 0; i < Points::points_per_batch; i += n_lanes)
        ratio = min(ratio, load_lanes(ratios + first + i));
      for (const ErosionCriterion::Limit &limit : erosion.limits())
      {
        const double *const values = points.material_points().component(limit.field, 0) + first;
        Lanes mean = 0.;
        for (unsigned int i = 0; i < Points::points_per_batch; i += n_lanes)
          mean += load_lanes(values + i);
        mean /= double(Points::n_points);
        where(mean >= limit.value, reaches) = 1.;
      }
      if (all_of(reaches < 1. && ratio > small_volume))
        continue;
      for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
        if (reaches[lane] >= 1. ||
            (!(ratio[lane] > small_volume) &&
             !integration.is_volume_positive(points, batch * n_lanes + lane, position)))
          failed_places.push_back(batch * n_lanes + lane);
    }
    return failed_places;
  }
} // namespace tombolo
