// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_limits.h>

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_size.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  StepLimit smoothed_diffusion_limit(const CellBatches<dim> &cells, const double diffusivity,
                                     const NodalVector &position)
  {
    constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
    StepLimit limit;
    limit.entity = "cell";
    if (diffusivity == 0.)
      return limit;
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      Lanes x[n_corners][dim];
      for (unsigned int k = 0; k < n_corners; ++k)
        gather_nodes<dim>(position.data(), cells.nodes(batch) + k * n_lanes, x[k]);
      Lanes shortest = 1e300;
      for (unsigned int k = 0; k < n_corners; ++k)
        for (unsigned int other = 0; other < k; ++other)
          shortest = min(shortest, internal::squared_distance(x[k], x[other]));
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        if (shortest[lane] / (2. * diffusivity) < limit.time_step)
        {
          limit.time_step = shortest[lane] / (2. * diffusivity);
          for (unsigned int d = 0; d < dim; ++d)
            limit.place[d] = x[0][d][lane];
        }
    }
    return limit;
  }

  template StepLimit smoothed_diffusion_limit(const CellBatches<2> &, double, const NodalVector &);
  template StepLimit smoothed_diffusion_limit(const CellBatches<3> &, double, const NodalVector &);
} // namespace tombolo
