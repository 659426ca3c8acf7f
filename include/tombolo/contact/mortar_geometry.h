// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace tombolo
{
  /** The vector @p tangent, across the unit vector @p before, in the shortest rotation that takes
   * @p before to @p now. */
  template <int dim>
  dealii::Tensor<1, dim> rotated_tangent(const dealii::Tensor<1, dim> &tangent,
                                         const dealii::Tensor<1, dim> &before,
                                         const dealii::Tensor<1, dim> &now)
  {
    const double cosine = before * now;
    if (!(cosine > -0.5)) // no small rotation
      return tangent - (tangent * now) * now;
    return tangent - (now * tangent) / (1. + cosine) * (before + now);
  }

  /** The least mass over area of these nodes. */
  inline double least_mass_per_area(const std::vector<unsigned int> &nodes,
                                    const std::vector<double> &areas, const NodalVector &mass)
  {
    double least = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (*mass.node(nodes[k]) > 0. && areas[k] > 0.)
        least = std::min(least, *mass.node(nodes[k]) / areas[k]);
    return least;
  }
} // namespace tombolo
