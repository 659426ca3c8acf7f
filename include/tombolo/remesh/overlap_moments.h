// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/simplex_overlap.h>

namespace tombolo
{
  /**
   * Integrals over what an old and a new simplex have in common, over the volume of the new one: of
   * the products of 1, b_1, ..., b_dim with each other, where b are the barycentric coordinates of
   * the new simplex. Fields that are linear in the old simplex need no others. Entries beyond are
   * zero.
   */
  template <int dim>
  struct OverlapMoments
  {
    alignas(64) double products[4][4] = {};

    /** ∫ 1 */
    double volume() const
    {
      return products[0][0];
    }

    void add(const SimplexOverlap::Piece<dim> &piece)
    {
      const double share = SimplexOverlap::fraction<dim>(piece);
      const double weight = share / ((dim + 1) * (dim + 2));
      double sum[dim + 1] = {dim + 1.};
      for (const auto &vertex : piece)
        for (unsigned int j = 1; j <= dim; ++j)
          sum[j] += vertex.in_new[j];
      for (unsigned int j = 0; j <= dim; ++j)
        for (unsigned int k = 0; k <= dim; ++k)
        {
          double product = sum[j] * sum[k];
          for (const auto &vertex : piece)
            product += (j == 0 ? 1. : vertex.in_new[j]) * (k == 0 ? 1. : vertex.in_new[k]);
          products[j][k] += weight * product;
        }
    }
  };
} // namespace tombolo
