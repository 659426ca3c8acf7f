// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/remesh/simplex_overlap.h>

namespace tombolo
{
  /**
   * Integrals over what an old and a new simplex have in common, of the products of their
   * barycentric coordinates b, all over the volume of the new simplex. Fields that are linear in
   * the old simplex need no others. Rows have four entries; those beyond the last vertex are zero.
   */
  template <int dim>
  struct OverlapMoments
  {
    double volume = 0;                  ///< ∫ 1
    double of_new[4] = {};              ///< ∫ b_j of the new simplex
    double of_old[4] = {};              ///< ∫ b_i of the old one, after finish()
    double new_by_new[dim + 1][4] = {}; ///< ∫ b_j b_k
    double old_by_new[dim + 1][4] = {}; ///< ∫ b_i b_j, after finish()

    void add(const SimplexOverlap::Piece<dim> &piece)
    {
      const double share = SimplexOverlap::fraction<dim>(piece);
      const double weight = share / ((dim + 1) * (dim + 2));
      double sum[dim + 1] = {};
      for (const auto &vertex : piece)
        for (unsigned int j = 0; j <= dim; ++j)
          sum[j] += vertex.in_new[j];
      volume += share;
      for (unsigned int j = 0; j <= dim; ++j)
      {
        of_new[j] += share / (dim + 1) * sum[j];
        for (unsigned int k = 0; k <= dim; ++k)
        {
          double product = sum[j] * sum[k];
          for (const auto &vertex : piece)
            product += vertex.in_new[j] * vertex.in_new[k];
          new_by_new[j][k] += weight * product;
        }
      }
    }

    /** @p old_at_new: the coordinates of the old simplex at the vertices of the new one, which are
     * rows: each is linear in those of the new one. */
    void finish(const double (&old_at_new)[4][4])
    {
      NodeLanes sum = 0.;
      for (unsigned int j = 0; j <= dim; ++j)
        sum += of_new[j] * load_node(old_at_new[j]);
      store_node(sum, of_old);
      for (unsigned int i = 0; i <= dim; ++i)
      {
        NodeLanes products = 0.;
        for (unsigned int k = 0; k <= dim; ++k)
          products += old_at_new[k][i] * load_node(new_by_new[k]);
        store_node(products, old_by_new[i]);
      }
    }
  };
} // namespace tombolo
