// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/node_partition.h>

#include <numeric>
#include <random>
#include <vector>

namespace tombolo
{
  /** Particles for tests and benchmarks: node_stride doubles a node. */
  struct ParticleCloud
  {
    std::vector<double> position;
    std::vector<double> support;
    std::vector<unsigned int> nodes;

    unsigned int size() const
    {
      return static_cast<unsigned int>(nodes.size());
    }

    const double *x(const unsigned int node) const
    {
      return position.data() + std::size_t(node) * node_stride;
    }

    const double *a(const unsigned int node) const
    {
      return support.data() + std::size_t(node) * node_stride;
    }

    void add(const double *x, const double *a, const unsigned int dim)
    {
      for (unsigned int d = 0; d < node_stride; ++d)
      {
        position.push_back(d < dim ? x[d] : 0.);
        support.push_back(d < dim ? a[d] : 0.);
      }
      nodes.push_back(size());
    }
  };

  /** A lattice of n nodes an axis, x fastest, spacing one, disordered by up to @p disorder in
   * either direction, moved by @p shift. */
  template <int dim>
  ParticleCloud lattice_cloud(const unsigned int n, const double dilation,
                              const double disorder = 0., const double shift = 0.)
  {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-disorder, disorder);
    ParticleCloud cloud;
    for (unsigned int k = 0; k < (dim == 3 ? n : 1); ++k)
      for (unsigned int j = 0; j < n; ++j)
        for (unsigned int i = 0; i < n; ++i)
        {
          const double index[3] = {double(i), double(j), double(k)};
          double x[3], a[3];
          for (unsigned int d = 0; d < dim; ++d)
          {
            x[d] = shift + index[d] + (disorder > 0. ? uniform(generator) : 0.);
            a[d] = dilation * (1. + (disorder > 0. ? 0.5 * uniform(generator) : 0.));
          }
          cloud.add(x, a, dim);
        }
    return cloud;
  }

  /** @p n particles at random in the unit cube. */
  template <int dim>
  ParticleCloud random_cloud(const unsigned int n, const double smallest_support,
                             const double largest_support, const double shift = 0.)
  {
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> uniform(0., 1.);
    ParticleCloud cloud;
    for (unsigned int i = 0; i < n; ++i)
    {
      double x[3], a[3];
      for (unsigned int d = 0; d < dim; ++d)
      {
        x[d] = shift + uniform(generator);
        a[d] = smallest_support + (largest_support - smallest_support) * uniform(generator);
      }
      cloud.add(x, a, dim);
    }
    return cloud;
  }
} // namespace tombolo
