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

    /** Of the simplex with these @p vertices. */
    void add(const SimplexIntegrals<dim> &integrals, const std::uint8_t *const vertices)
    {
      const std::size_t of_point = values.size() / n_points;
      for (unsigned int j = 0; j <= dim; ++j)
      {
        mass[vertices[j]] += integrals.mass[j];
        for (unsigned int k = 0; k <= dim; ++k)
          matrix[vertices[j]][vertices[k]] += integrals.matrix[j][k];
        for (std::size_t first = 0; first < of_point; first += 2 * node_stride)
        {
          double *const to = values.data() + vertices[j] * of_point + first;
          const double *const from =
              integrals.values.data() + first * (dim + 1) + std::size_t(j) * 2 * node_stride;
          store_eight(load_eight(to) + load_eight(from), to);
        }
      }
    }

    void give(typename CellOverlap<dim>::Integrals &cell) const
    {
      constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
      const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
      const std::size_t of_point = values.size() / n_points;
      EightDoubles rows[n_corners], masses = 0.;
      for (EightDoubles &row : rows)
        row = 0.;
      for (unsigned int p = 0; p < n_points; ++p)
      {
        masses += mass[p] * load_eight(points.of_point[p]);
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
      double of_corners[8];
      store_eight(masses, of_corners);
      std::copy_n(of_corners, n_corners, cell.mass.data());
      for (unsigned int a = 0; a < n_corners; ++a)
      {
        store_eight(rows[a], of_corners);
        std::copy_n(of_corners, n_corners, cell.matrix.data() + std::size_t(a) * n_corners);
      }
    }

  private:
    double matrix[n_points][n_points] = {}, mass[n_points] = {};
    std::vector<double> values; // by point, field and slot
    unsigned int n_fields;
  };
} // namespace tombolo
