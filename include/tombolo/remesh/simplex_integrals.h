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

  /** Integrals over one simplex of after, in its barycentric coordinates. */
  template <int dim>
  struct SimplexIntegrals
  {
    static constexpr unsigned int n_slots = 2 * node_stride; // of two fields
    double matrix[dim + 1][4] = {}, mass[4] = {};
    std::vector<double> values; // by two fields, vertex, field and slot

    explicit SimplexIntegrals(const unsigned int n_fields)
        : values(n_pairs_of(n_fields) * (dim + 1) * n_slots, 0.)
    {}

    void clear()
    {
      std::fill_n(mass, 4, 0.);
      for (auto &row : matrix)
        std::fill_n(row, 4, 0.);
      std::fill(values.begin(), values.end(), 0.);
    }

    /** What it has of an old simplex, of whose density it would have the mass @p of_simplex in
     * all; the fields have the values @p of_old at points of the old cell (values_at_points()),
     * of which @p vertices are those of the simplex. */
    void add(const OverlapMoments<dim> &moments, const double of_simplex,
             const std::vector<double> &of_old, const std::uint8_t *const vertices)
    {
      const auto add_product = [&](const double *const from, double *const to)
      { store_node(load_node(to) + of_simplex * load_node(from), to); };
      add_product(moments.of_new, mass);
      for (unsigned int j = 0; j <= dim; ++j)
        add_product(moments.new_by_new[j], matrix[j]);
      const std::size_t of_point = values.size() / (dim + 1);
      for (std::size_t first = 0; first < of_point; first += n_slots)
      {
        EightDoubles z[dim + 1];
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i <= dim; ++i)
          z[i] = of_simplex * load_eight(of_old.data() + vertices[i] * of_point + first);
        double *const to = values.data() + first * (dim + 1);
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j <= dim; ++j)
        {
          EightDoubles sum = load_eight(to + j * n_slots);
          TOMBOLO_UNROLL
          for (unsigned int i = 0; i <= dim; ++i)
            sum += moments.old_by_new[i][j] * z[i];
          store_eight(sum, to + j * n_slots);
        }
      }
    }
  };

  /** Those of a new simplex that is the old one. */
  template <int dim>
  OverlapMoments<dim> moments_of_whole_simplex()
  {
    SimplexOverlap::Piece<dim> piece;
    double unit[4][4] = {};
    for (unsigned int k = 0; k <= dim; ++k)
      for (unsigned int j = 0; j <= dim; ++j)
        piece[k].in_new[j] = unit[k][j] = k == j ? 1. : 0.;
    OverlapMoments<dim> result;
    result.add(piece);
    result.finish(unit);
    return result;
  }

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
