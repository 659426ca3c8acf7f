// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/node_lanes.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace tombolo
{
  namespace internal
  {
    /** Of n_lanes places of node_stride doubles, components 0 ... dim-1. */
    template <int dim>
    void load_transposed(const double *const place[n_lanes], const std::size_t offset,
                         Lanes (&component)[dim])
    {
      NodeLanes node[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        node[lane] = load_node(place[lane] + offset);
      nodes_to_lanes(node, component);
    }

    /** n_lanes rows that are computed together, one in each lane, and the intermediate values of
     * their neighbours: for each slot (the k-th neighbour of all rows) and axis one Lanes. */
    template <int dim>
    struct RowBatch
    {
      static constexpr int n = dim + 1;
      static constexpr unsigned int n_of_record = 2 * node_stride; ///< position, inverse support

      unsigned int n_rows, longest, shortest;
      const unsigned int *neighbours[n_lanes];
      std::size_t start[n_lanes]; ///< of the row's coefficients, from those of the first row
      unsigned int length[n_lanes];
      const double *center_record[n_lanes];
      alignas(64) double outside[n_lanes][n_of_record];
      Lanes center[dim], scale[dim]; ///< x_I and 1/a_I
      double *offset, *inverse_support, *weight, *slope, *result;

      void set_rows(const unsigned int first_row, const unsigned int end_row, const Stencils &shape,
                    const double *records)
      {
        n_rows = std::min(n_lanes, end_row - first_row);
        longest = 0;
        shortest = std::numeric_limits<unsigned int>::max();
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const unsigned int row = first_row + std::min(lane, n_rows - 1);
          start[lane] = shape.row_start[row] - shape.row_start[first_row];
          length[lane] = static_cast<unsigned int>(shape.row_start[row + 1] - shape.row_start[row]);
          neighbours[lane] = shape.neighbour.data() + shape.row_start[row];
          center_record[lane] = records + std::size_t(shape.particle_node[row]) * n_of_record;
          longest = std::max(longest, length[lane]);
          shortest = std::min(shortest, length[lane]);
        }
        // Short rows are filled up with a neighbour outside its own support, which weighs nothing.
        if (shortest != longest)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            std::copy_n(center_record[lane], n_of_record, outside[lane]);
            outside[lane][0] += 4. / outside[lane][node_stride];
          }
      }

      /** Differences x_J - x_I over the supports of J (@p coordinate) and of I (offset). */
      void gather(const double *records, double *coordinate)
      {
        load_transposed(center_record, 0, center);
        load_transposed(center_record, node_stride, scale);
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const double *record[n_lanes];
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            record[lane] = slot < shortest || slot < length[lane]
                               ? records + std::size_t(neighbours[lane][slot]) * n_of_record
                               : outside[lane];
          Lanes x[dim], inverse[dim];
          load_transposed(record, 0, x);
          load_transposed(record, node_stride, inverse);
          for (unsigned int d = 0; d < dim; ++d)
          {
            const std::size_t i = (std::size_t(slot) * dim + d) * n_lanes;
            const Lanes difference = x[d] - center[d];
            store_lanes(difference * inverse[d], &coordinate[i]);
            store_lanes(difference * scale[d], &offset[i]);
            store_lanes(inverse[d], &inverse_support[i]);
          }
        }
      }

      /** Adds up M, and puts w_J into result and ∂_k w_J in the place of their factors. */
      void multiply_weights(Lanes (&moment)[n][n])
      {
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const std::size_t i = std::size_t(slot) * dim * n_lanes;
          Lanes q[n], factor[dim], of_axis[dim];
          for (unsigned int d = 0; d < dim; ++d)
          {
            q[d + 1] = load_lanes(&offset[i + d * n_lanes]);
            factor[d] = load_lanes(&weight[i + d * n_lanes]);
            of_axis[d] = -load_lanes(&slope[i + d * n_lanes]) *
                         load_lanes(&inverse_support[i + d * n_lanes]);
          }
          Lanes w;
          if (dim == 2)
          {
            w = factor[0] * factor[1];
            of_axis[0] *= factor[1];
            of_axis[1] *= factor[0];
          }
          else
          {
            constexpr unsigned int z = dim - 1;
            const Lanes xy = factor[0] * factor[1];
            w = xy * factor[z];
            of_axis[0] *= factor[1] * factor[z];
            of_axis[1] *= factor[0] * factor[z];
            of_axis[z] *= xy;
          }
          store_lanes(w, &result[std::size_t(slot) * n_lanes]);
          for (unsigned int d = 0; d < dim; ++d)
            store_lanes(of_axis[d], &slope[i + d * n_lanes]);
          moment[0][0] += w;
          for (int k = 1; k < n; ++k)
          {
            const Lanes wq = w * q[k];
            moment[k][0] += wq;
            for (int l = 1; l <= k; ++l)
              moment[k][l] += wq * q[l];
          }
        }
      }

      /** Subtracts Σ_J ∂_k w_J (c · q_J) q_J from b_k. */
      void subtract_slopes(const Lanes (&c)[n], Lanes (&b)[dim][n]) const
      {
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const std::size_t i = std::size_t(slot) * dim * n_lanes;
          Lanes q[n];
          Lanes cq = c[0];
          for (unsigned int d = 0; d < dim; ++d)
          {
            q[d + 1] = load_lanes(&offset[i + d * n_lanes]);
            cq += c[d + 1] * q[d + 1];
          }
          for (unsigned int d = 0; d < dim; ++d)
          {
            const Lanes t = load_lanes(&slope[i + d * n_lanes]) * cq;
            b[d][0] -= t;
            for (int k = 1; k < n; ++k)
              b[d][k] -= t * q[k];
          }
        }
      }

      /** φ_J = (c · q_J) w_J and ∇φ_J = (b · q_J) w_J + (c · q_J) ∇w_J. */
      void write(const Lanes (&c)[n], const Lanes (&b)[dim][n], double *value,
                 double *gradient) const
      {
        for (unsigned int slot = 0; slot < longest; ++slot)
        {
          const std::size_t i = std::size_t(slot) * dim * n_lanes;
          const Lanes w = load_lanes(&result[std::size_t(slot) * n_lanes]);
          Lanes cq = c[0];
          Lanes bq[dim];
          for (unsigned int d = 0; d < dim; ++d)
            bq[d] = b[d][0];
          for (unsigned int k = 0; k < dim; ++k)
          {
            const Lanes q = load_lanes(&offset[i + k * n_lanes]);
            cq += c[k + 1] * q;
            for (unsigned int d = 0; d < dim; ++d)
              bq[d] += b[d][k + 1] * q;
          }
          store_lanes(cq * w, &result[std::size_t(slot) * n_lanes]);
          Lanes g[dim];
          for (unsigned int d = 0; d < dim; ++d)
            g[d] = bq[d] * w + load_lanes(&slope[i + d * n_lanes]) * cq;
          NodeLanes node[n_lanes];
          lanes_to_nodes(g, node);
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            if (slot < length[lane])
              std::memcpy(gradient + (start[lane] + slot) * Stencils::n_gradient, &node[lane],
                          Stencils::n_gradient * sizeof(double));
        }
        for (unsigned int lane = 0; lane < n_rows; ++lane)
          for (unsigned int slot = 0; slot < length[lane]; ++slot)
            value[start[lane] + slot] = result[std::size_t(slot) * n_lanes + lane];
      }
    };
  } // namespace internal
} // namespace tombolo
