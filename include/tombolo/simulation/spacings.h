// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/part.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  /** The least and the largest spacing V^(1/dim) of the initial volumes of cells, or of
   * particles, of a part; the first is larger where there are none. Collective. */
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
    return {{dealii::Utilities::MPI::min(result[0], communicator),
             dealii::Utilities::MPI::max(result[1], communicator)}};
  }
} // namespace tombolo
