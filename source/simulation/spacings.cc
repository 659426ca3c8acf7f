// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/spacings.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  template <int dim>
  std::array<double, 2> spacings_of(const Part<dim> &part, const MPI_Comm communicator)
  {
    const MaterialPoints &points = part.formulation->points();
    const double *const volume = points.component(MaterialPoints::volume, 0),
                        *const ratio = points.component(MaterialPoints::volume_ratio, 0);
    const bool is_of_particles = part.particles != nullptr;
    const unsigned int n =
        is_of_particles ? part.particles->stencils().n_particles() : part.formulation->n_cells();
    std::array<double, 2> result{{1e300, 0.}};
    for (unsigned int k = 0; k < n; ++k)
    {
      double sum = 0;
      const unsigned int n_points = is_of_particles ? 1 : part.formulation->n_points_per_cell();
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const unsigned int point = is_of_particles ? k : part.formulation->point_of_cell(k, q);
        sum += volume[point] / ratio[point];
      }
      const double spacing = std::pow(sum, 1. / dim);
      result = {{std::min(result[0], spacing), std::max(result[1], spacing)}};
    }
    return {{Utilities::MPI::min(result[0], communicator),
             Utilities::MPI::max(result[1], communicator)}};
  }

  template std::array<double, 2> spacings_of(const Part<2> &, MPI_Comm);
  template std::array<double, 2> spacings_of(const Part<3> &, MPI_Comm);
} // namespace tombolo
