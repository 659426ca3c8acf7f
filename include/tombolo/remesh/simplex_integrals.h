// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/eight_doubles.h>
#include <tombolo/remesh/overlap_moments.h>
#include <tombolo/remesh/simplex_points.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /** The number of pairs of fields: they are added two at a time. */
  inline std::size_t n_pairs_of(const std::size_t n_fields)
  {
    return (n_fields + 1) / 2;
  }

  /** Integrals over one simplex of after with the functions 1, b_1, ..., b_dim, where b are its
   * barycentric coordinates. */
  template <int dim>
  struct SimplexIntegrals
  {
    static constexpr unsigned int n_slots = 2 * node_stride; // of two fields
    double products[dim + 1][4] = {};                        ///< of the functions
    std::vector<double> values; ///< of fields, by two fields, function, field and slot

    explicit SimplexIntegrals(const unsigned int n_fields)
        : values(n_pairs_of(n_fields) * (dim + 1) * n_slots, 0.)
    {}

    void clear()
    {
      for (auto &row : products)
        std::fill_n(row, 4, 0.);
      std::fill(values.begin(), values.end(), 0.);
    }

    /** What it has of an old simplex, of whose density it would have the mass @p of_simplex in
     * all. @p old_at_new: the coordinates of the old simplex at the vertices of the new one, rows;
     * the fields have the values @p of_old at points of the old cell (values_at_points()), of which
     * @p vertices are those of the simplex. */
    void add(const OverlapMoments<dim> &moments, const double of_simplex,
             const double (&old_at_new)[4][4], const std::vector<double> &of_old,
             const std::uint8_t *const vertices)
    {
      double of_density[dim + 1][4];
      TOMBOLO_UNROLL
      for (unsigned int j = 0; j <= dim; ++j)
      {
        const NodeLanes row = of_simplex * load_node(moments.products[j]);
        store_node(row, of_density[j]);
        store_node(load_node(products[j]) + row, products[j]);
      }
      const std::size_t of_point = values.size() / (dim + 1);
      for (std::size_t first = 0; first < of_point; first += n_slots)
      {
        // The fields as linear functions of the new coordinates.
        EightDoubles of_new[dim + 1];
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i <= dim; ++i)
        {
          const EightDoubles z = load_eight(of_old.data() + vertices[i] * of_point + first);
          TOMBOLO_UNROLL
          for (unsigned int k = 0; k <= dim; ++k)
            of_new[k] = i == 0 ? old_at_new[k][i] * z : of_new[k] + old_at_new[k][i] * z;
        }
        TOMBOLO_UNROLL
        for (unsigned int k = 1; k <= dim; ++k)
          of_new[k] -= of_new[0];
        double *const to = values.data() + first * (dim + 1);
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j <= dim; ++j)
        {
          EightDoubles sum = load_eight(to + j * n_slots);
          TOMBOLO_UNROLL
          for (unsigned int k = 0; k <= dim; ++k)
            sum += of_density[j][k] * of_new[k];
          store_eight(sum, to + j * n_slots);
        }
      }
    }

    /** What it has of itself. */
    void add_whole(const double mass, const std::vector<double> &of_old,
                   const std::uint8_t *const vertices)
    {
      static const OverlapMoments<dim> moments = moments_of_whole_simplex();
      constexpr double unit[4][4] = {
          {1., 0., 0., 0.}, {0., 1., 0., 0.}, {0., 0., 1., 0.}, {0., 0., 0., 1.}};
      add(moments, mass, unit, of_old, vertices);
    }

    /** Those with b_j in place of the functions, in which the sums of the others are. */
    void take_coordinates()
    {
      TOMBOLO_UNROLL
      for (unsigned int j = 1; j <= dim; ++j)
        store_node(load_node(products[0]) - load_node(products[j]), products[0]);
      for (auto &row : products)
        for (unsigned int k = 1; k <= dim; ++k)
          row[0] -= row[k];
      const std::size_t of_point = values.size() / (dim + 1);
      for (std::size_t first = 0; first < of_point; first += n_slots)
      {
        double *const of_first = values.data() + first * (dim + 1);
        for (unsigned int j = 1; j <= dim; ++j)
          store_eight(load_eight(of_first) - load_eight(of_first + j * n_slots), of_first);
      }
    }

  private:
    static OverlapMoments<dim> moments_of_whole_simplex()
    {
      SimplexOverlap::Piece<dim> piece;
      for (unsigned int k = 0; k <= dim; ++k)
        for (unsigned int j = 0; j <= dim; ++j)
          piece[k].in_new[j] = k == j ? 1. : 0.;
      OverlapMoments<dim> result;
      result.add(piece);
      return result;
    }
  };

  /** Values of fields at the points of a cell, by point, field and slot, from those at corners.
   * Where the number of fields is odd, there is one more, of zeros. */
  template <int dim>
  void values_at_points(const double *const of_corners, const std::size_t n_fields,
                        std::vector<double> &result)
  {
    const auto &shares = SimplexPoints<dim>::instance().shares;
    const std::size_t n = n_fields * node_stride;
    const std::size_t of_point = n_pairs_of(n_fields) * 2 * node_stride;
    result.assign(shares.size() * of_point, 0.);
    for (std::size_t p = 0; p < shares.size(); ++p)
      for (unsigned int a = 0; a < SimplexPoints<dim>::n_corners; ++a)
        if (shares[p][a] != 0.)
          for (std::size_t c = 0; c < n; ++c)
            result[p * of_point + c] += shares[p][a] * of_corners[a * n + c];
  }
} // namespace tombolo
