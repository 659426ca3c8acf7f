// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/simplex_overlap.h>

namespace tombolo
{
  /**
   * Integrals over what an old and a new simplex have in common, of the products of their
   * barycentric coordinates b, all over the volume of the old simplex. Fields that are linear in
   * the old simplex need no others.
   */
  template <int dim>
  struct OverlapMoments
  {
    double volume = 0;                        ///< ∫ 1
    double of_new[dim + 1] = {};              ///< ∫ b_j of the new simplex
    double of_old[dim + 1] = {};              ///< ∫ b_i of the old one
    double new_by_new[dim + 1][dim + 1] = {}; ///< ∫ b_j b_k
    double new_by_old[dim + 1][dim + 1] = {}; ///< ∫ b_j b_i

    void add(const SimplexOverlap::Piece<dim> &piece)
    {
      const double share = SimplexOverlap::fraction<dim>(piece);
      const double weight = share / ((dim + 1) * (dim + 2));
      double sum_new[dim + 1] = {}, sum_old[dim + 1] = {};
      for (const auto &vertex : piece)
        for (unsigned int j = 0; j <= dim; ++j)
        {
          sum_new[j] += vertex.in_new[j];
          sum_old[j] += vertex.in_old[j];
        }
      volume += share;
      for (unsigned int j = 0; j <= dim; ++j)
      {
        of_new[j] += share / (dim + 1) * sum_new[j];
        of_old[j] += share / (dim + 1) * sum_old[j];
        for (unsigned int k = 0; k <= dim; ++k)
        {
          double by_new = sum_new[j] * sum_new[k], by_old = sum_new[j] * sum_old[k];
          for (const auto &vertex : piece)
          {
            by_new += vertex.in_new[j] * vertex.in_new[k];
            by_old += vertex.in_new[j] * vertex.in_old[k];
          }
          new_by_new[j][k] += weight * by_new;
          new_by_old[j][k] += weight * by_old;
        }
      }
    }
  };
} // namespace tombolo
