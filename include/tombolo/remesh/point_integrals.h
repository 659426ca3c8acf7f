// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/simplex_integrals.h>
#include <tombolo/remesh/simplex_points.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /** Integrals over a cell of after, with the functions of its points (SimplexPoints). */
  template <int dim>
  class PointIntegrals
  {
  public:
    static constexpr unsigned int n_points = SimplexPoints<dim>::n_points;

    explicit PointIntegrals(const unsigned int n_fields)
        : values(n_pairs_of(n_fields) * n_points * 2 * node_stride, 0.), n_fields(n_fields)
    {}

    void clear()
    {
      std::fill_n(&matrix[0][0], n_points * n_points, 0.);
      std::fill(values.begin(), values.end(), 0.);
    }

    /** Of the simplex with these @p vertices, with its coordinates as functions. */
    void add(const SimplexIntegrals<dim> &integrals, const std::uint8_t *const vertices)
    {
      const std::size_t of_point = values.size() / n_points;
      for (unsigned int j = 0; j <= dim; ++j)
      {
        for (unsigned int k = 0; k <= dim; ++k)
          matrix[vertices[j]][vertices[k]] += integrals.products[j][k];
        for (std::size_t first = 0; first < of_point; first += 2 * node_stride)
        {
          double *const to = values.data() + vertices[j] * of_point + first;
          const double *const from =
              integrals.values.data() + first * (dim + 1) + std::size_t(j) * 2 * node_stride;
          store_eight(load_eight(to) + load_eight(from), to);
        }
      }
    }

    /** Adds them to those of a cell. */
    void give(typename CellOverlap<dim>::Integrals &cell) const
    {
      constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
      const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
      const std::size_t of_point = values.size() / n_points;
      EightDoubles rows[n_corners];
      for (EightDoubles &row : rows)
        row = 0.;
      for (unsigned int p = 0; p < n_points; ++p)
      {
        EightDoubles half = 0.;
        for (unsigned int q = 0; q < n_points; ++q)
          half += matrix[p][q] * load_eight(points.of_point[q]);
        for (unsigned int a = 0; a < n_corners; ++a)
        {
          const double share = points.shares[p][a];
          if (share == 0.)
            continue;
          rows[a] += share * half;
          for (unsigned int field = 0; field < n_fields; ++field)
            for (unsigned int slot = 0; slot < node_stride; ++slot)
              cell.values[(std::size_t(field) * n_corners + a) * node_stride + slot] +=
                  share * values[p * of_point + field * node_stride + slot];
        }
      }
      for (unsigned int a = 0; a < n_corners; ++a)
      {
        double of_corners[8];
        store_eight(rows[a], of_corners);
        for (unsigned int b = 0; b < n_corners; ++b)
        {
          cell.matrix[std::size_t(a) * n_corners + b] += of_corners[b];
          cell.mass[b] += of_corners[b]; // the functions add up to one
        }
      }
    }

  private:
    double matrix[n_points][n_points] = {};
    std::vector<double> values; // by point, field and slot
    unsigned int n_fields;
  };
} // namespace tombolo
