// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>

#include "particle_clouds.h"

#include <cmath>
#include <functional>
#include <vector>

namespace tombolo
{
  /** The kernel of Yang, Liu and Peng over the distance, normalized; support 2h. */
  template <int dim>
  struct HyperbolicKernel
  {
    double h;

    double scale() const
    {
      return dim == 2 ? 1. / (3. * dealii::numbers::PI * h * h)
                      : 15. / (62. * dealii::numbers::PI * h * h * h);
    }
    double value(const double r) const
    {
      const double q = r / h;
      return scale() * (q < 1. ? q * q * q - 6. * q + 6. : q < 2. ? std::pow(2. - q, 3) : 0.);
    }
    /** -dW/dr */
    double slope(const double r) const
    {
      const double q = r / h;
      return scale() / h * (q < 1. ? 6. - 3. * q * q : q < 2. ? 3. * (2. - q) * (2. - q) : 0.);
    }
  };

  /** SPH rows of the first @p n_rows particles of a cloud, whose particles all have the volume @p
   * volume: φ of the particle itself, ∇φ_j = V ∇_iW_ij, and minus their sum at the particle. */
  template <int dim>
  Stencils radial_rows(const ParticleCloud &cloud, const unsigned int n_rows, const double volume,
                       const HyperbolicKernel<dim> &kernel, const double mass = 1.)
  {
    Stencils shape;
    shape.row_start = {0};
    for (unsigned int i = 0; i < n_rows; ++i)
    {
      shape.particle_node.push_back(i);
      shape.mass.push_back(mass);
      shape.coefficient_start.push_back(shape.neighbour.size());
      std::vector<double> sum(3, 0.);
      std::size_t own = 0;
      for (unsigned int j = 0; j < cloud.size(); ++j)
      {
        double offset[3], squared = 0;
        for (unsigned int d = 0; d < 3; ++d)
        {
          offset[d] = cloud.x(j)[d] - cloud.x(i)[d];
          squared += offset[d] * offset[d];
        }
        const double r = std::sqrt(squared);
        if (r >= 2. * kernel.h)
          continue;
        if (i == j)
          own = shape.neighbour.size();
        shape.neighbour.push_back(j);
        for (unsigned int d = 0; d < 3; ++d)
        {
          const double gradient = r > 0. ? volume * kernel.slope(r) * offset[d] / r : 0.;
          sum[d] += gradient;
          shape.gradient.push_back(gradient);
        }
        shape.value.push_back(i == j ? 1. : 0.);
      }
      for (unsigned int d = 0; d < 3; ++d)
        shape.gradient[3 * own + d] -= sum[d];
      shape.row_start.push_back(shape.neighbour.size());
    }
    shape.gradient.push_back(0.);
    return shape;
  }
} // namespace tombolo
