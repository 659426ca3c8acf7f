// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/pair_interactions.h>

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

  /** Pairs of the first @p n_rows particles of a cloud with all others within the support, as rows
   * without values and gradients; all particles have the same volume and mass. */
  template <int dim>
  class RadialPairs
  {
  public:
    RadialPairs(const ParticleCloud &cloud, const unsigned int n_rows,
                const HyperbolicKernel<dim> &kernel, const double mass = 1.)
        : slope(2. * kernel.h, [&](const double r) { return kernel.slope(r); }),
          node_volumes(cloud.size() * node_stride, 0.), volume(n_rows, 1.)
    {
      for (unsigned int i = 0; i < cloud.size(); ++i)
      {
        node_volumes[i * node_stride] = 1.;
        node_volumes[i * node_stride + 1] = i < n_rows ? 1. : 0.;
      }
      shape.row_start = {0};
      for (unsigned int i = 0; i < n_rows; ++i)
      {
        shape.particle_node.push_back(i);
        shape.mass.push_back(mass);
        shape.coefficient_start.push_back(0);
        for (unsigned int j = 0; j < cloud.size(); ++j)
        {
          double squared = 0;
          for (unsigned int d = 0; d < 3; ++d)
            squared += std::pow(cloud.x(j)[d] - cloud.x(i)[d], 2);
          if (j == i)
            own_entry.push_back(shape.neighbour.size());
          if (squared < 4. * kernel.h * kernel.h)
            shape.neighbour.push_back(j);
        }
        shape.row_start.push_back(shape.neighbour.size());
      }
    }

    PairRows rows() const
    {
      return {&shape,
              own_entry.data(),
              node_volumes.size() / node_stride,
              node_volumes.data(),
              volume.data(),
              &slope};
    }

    Stencils shape;
    RadialTable slope;
    std::vector<std::size_t> own_entry;
    std::vector<double> node_volumes, volume;
  };
} // namespace tombolo
