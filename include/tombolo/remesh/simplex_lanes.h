// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/remesh/simplex_points.h>

namespace tombolo
{
  /** A cell by the places of its points (SimplexPoints), and its simplices, eight at a time. */
  template <int dim>
  class SimplexLanes
  {
  public:
    static constexpr unsigned int n_padded = SimplexPoints<dim>::n_padded;
    static constexpr unsigned int n_groups = n_padded / 8;
    /** The volume of a simplex over the determinant of its edges. */
    static constexpr double volume_factor = dim == 3 ? -1. / 6. : 1. / 2.;

    explicit SimplexLanes(const typename SubCells<dim>::Corners &corners);

    double place[dim][16]; ///< of points; those beyond repeat the first

    dealii::Point<dim> point(const unsigned int number) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = place[d][number];
      return result;
    }

    /** Of eight simplices: edges from the centre of the cell to the other vertices, by vertex and
     * component, and their determinant, which the gradients of the coordinates of these vertices
     * have as a common divisor of their @p cofactors. */
    struct Edges
    {
      EightDoubles edge[dim][dim], cofactor[dim][dim], determinant;
    };

    Edges edges(const unsigned int group) const
    {
      const auto &of_vertex = SimplexPoints<dim>::instance().of_vertex;
      Edges result;
      EightDoubles(&e)[dim][dim] = result.edge;
      EightDoubles(&c)[dim][dim] = result.cofactor;
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double centre = place[d][SimplexPoints<dim>::centre];
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < dim; ++k)
          e[k][d] = pick_eight(place[d], of_vertex[k] + std::size_t(8) * group) - centre;
      }
      if constexpr (dim == 2)
      {
        c[0][0] = e[1][1];
        c[0][1] = -e[1][0];
        c[1][0] = -e[0][1];
        c[1][1] = e[0][0];
      }
      else
      {
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < 3; ++k)
          TOMBOLO_UNROLL
        for (unsigned int d = 0; d < 3; ++d)
          c[k][d] = e[(k + 1) % 3][(d + 1) % 3] * e[(k + 2) % 3][(d + 2) % 3] -
                    e[(k + 1) % 3][(d + 2) % 3] * e[(k + 2) % 3][(d + 1) % 3];
      }
      result.determinant = e[0][0] * c[0][0];
      TOMBOLO_UNROLL
      for (unsigned int d = 1; d < dim; ++d)
        result.determinant += e[0][d] * c[0][d];
      return result;
    }

    /** The volumes of all simplices, and behind them what repeats the first. */
    void find_volumes(double (&volumes)[n_padded]) const
    {
      for (unsigned int group = 0; group < n_groups; ++group)
        store_eight(volume_factor * edges(group).determinant, volumes + std::size_t(8) * group);
    }
  };

  template <int dim>
  SimplexLanes<dim>::SimplexLanes(const typename SubCells<dim>::Corners &corners)
  {
    const auto &shares = SimplexPoints<dim>::instance().of_corner;
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int first = 0; first < 16; first += 8)
      {
        EightDoubles sum = corners[0][d] * load_eight(shares[0] + first);
        for (unsigned int a = 1; a < corners.size(); ++a)
          sum += corners[a][d] * load_eight(shares[a] + first);
        store_eight(sum, place[d] + first);
      }
  }
} // namespace tombolo
