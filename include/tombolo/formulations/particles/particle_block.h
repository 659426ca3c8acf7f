// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/fetch_ahead.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/materials/kinematics.h>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace tombolo
{
  /** Blocks of nodally integrated particles in a step: gradients, motion, forces. */
  namespace ParticleBlock
  {
    /** Particles treated together: their ∇φ, read for the gradients, are still in the
     * second-level cache when the forces need them, and one virtual call of the material serves
     * them all. */
    constexpr unsigned int block_size = 32;
    static_assert(block_size % n_lanes == 0, "Blocks are whole Lanes.");

    using RowBlock::load_columns;
    using RowBlock::node;
    using RowBlock::store_columns;
    using RowBlock::transposed;

    /** The matrices of a block, three columns of node_stride doubles for each particle. */
    struct BlockMatrices
    {
      alignas(64) double columns[block_size][3][node_stride];

      void set(const unsigned int index, const NodeLanes (&particle_columns)[3])
      {
        for (unsigned int j = 0; j < 3; ++j)
          store_node(particle_columns[j], columns[index][j]);
      }

      /** Particles from ... block_size - 1: @p diagonal times the identity. */
      void fill(const unsigned int from, const unsigned int to, const double diagonal)
      {
        for (unsigned int index = from; index < to; ++index)
          for (unsigned int j = 0; j < 3; ++j)
            for (unsigned int i = 0; i < node_stride; ++i)
              columns[index][j][i] = i == j ? diagonal : 0.;
      }
    };

    using BlockVectors = double[block_size][node_stride];

    /** ∂v/∂X and, where requested, F = ∂x/∂X of the particles of a block, and what φ makes of the
     * positions less those of the particles. In the plane ∇φ has two components. */
    template <int dim, bool with_deformation, bool with_residual>
    void gather_gradients(const Stencils &shape, const unsigned int first, const unsigned int last,
                          const double *position, const double *velocity,
                          BlockMatrices &velocity_gradient, BlockMatrices &deformation,
                          BlockVectors &residual)
    {
      for (unsigned int row = first; row < last; ++row)
      {
        fetch_ahead(shape, row, velocity);
        fetch_coefficients_ahead<with_residual, true>(shape, row);
        if constexpr (with_deformation || with_residual)
          fetch_ahead(shape, row, position);
        const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
        // Two chains of sums hide the latency of additions.
        NodeLanes h[3] = {0., 0., 0.}, odd_sums[3] = {0., 0., 0.};
        NodeLanes f[3] = {0., 0., 0.};
        NodeLanes r = 0.;
        const Stencils::Row stencil_row =
            with_residual ? shape.row(row) : shape.row_of_gradients(row);
        const auto add = [&](const unsigned int k, NodeLanes(&sum)[3])
        {
          const unsigned int neighbour = stencil_row.neighbour[k];
          const double *const gradient = stencil_row.gradient + k * Stencils::n_gradient;
          const NodeLanes v = load_node(node(velocity, neighbour));
          TOMBOLO_UNROLL
          for (unsigned int d = 0; d < dim; ++d)
            sum[d] += v * gradient[d];
          if constexpr (with_deformation || with_residual)
          {
            const NodeLanes offset = load_node(node(position, neighbour)) - own_position;
            if constexpr (with_deformation)
            {
              TOMBOLO_UNROLL
              for (unsigned int d = 0; d < dim; ++d)
                f[d] += offset * gradient[d];
            }
            if constexpr (with_residual)
              r += stencil_row.value[k] * offset;
          }
        };
        unsigned int k = 0;
        if constexpr (!with_deformation)
        {
          for (; k + 1 < stencil_row.size; k += 2)
          {
            add(k, h);
            add(k + 1, odd_sums);
          }
          TOMBOLO_UNROLL
          for (unsigned int d = 0; d < dim; ++d)
            h[d] += odd_sums[d];
        }
        for (; k < stencil_row.size; ++k)
          add(k, h);
        velocity_gradient.set(row - first, h);
        if constexpr (with_deformation)
          deformation.set(row - first, f);
        if constexpr (with_residual)
          store_node(r, residual[row - first]);
      }
    }

    /** Adds -K ∇φ to the forces of the neighbours of each particle of a block, and unless it is
     * null -φ times @p residual_forces, whose opposite the particle gets. */
    inline void scatter_force(const Stencils &shape, const unsigned int first,
                              const unsigned int last, const BlockMatrices &k,
                              const BlockVectors *const residual_forces, double *force)
    {
      for (unsigned int row = first; row < last; ++row)
      {
        fetch_ahead(shape, row, force);
        if (residual_forces == nullptr)
          RowBlock::subtract_row(shape.row_of_gradients(row), k.columns[row - first][0], force);
        else
          RowBlock::subtract_row(shape.row(row), k.columns[row - first][0],
                                 (*residual_forces)[row - first], shape.particle_node[row], force);
      }
    }

    /** Rows whose ∇φ does not describe their deformation count as undeformed. */
    inline void set_undeformed_rows(const Stencils &shape, const unsigned int first,
                                    const unsigned int last, BlockMatrices &deformation)
    {
      if (shape.is_uncorrected)
        deformation.fill(0, last - first, 1.);
      for (const auto *const rows : {&shape.rank_deficient_rows, &shape.uncorrected_rows})
        for (auto row = std::lower_bound(rows->begin(), rows->end(), first);
             row != rows->end() && *row < last; ++row)
          deformation.fill(*row - first, *row - first + 1, 1.);
    }

    /** Turns F of a block into F⁻ᵀ, whose columns are the rows of F⁻¹. */
    template <int dim>
    void invert_deformation(const Stencils &shape, const unsigned int first,
                            const unsigned int last, const double *position,
                            BlockMatrices &deformation)
    {
      const unsigned int n = last - first;
      for (unsigned int p = 0; p < n; p += n_lanes)
      {
        Matrix3<Lanes> f = load_columns(deformation.columns[p][0]);
        if constexpr (dim == 2)
          f(2, 2) = 1.;
        Lanes det;
        store_columns(transposed(inverse(f, det)), deformation.columns[p][0]);
        if (!all_of(det > 0.))
          for (unsigned int lane = 0; lane < n_lanes && p + lane < n; ++lane)
            if (!(det[lane] > 0.))
              throw RunError(
                  as_text("the particle at ",
                          position_text(vector_of<dim>(
                              node(position, shape.particle_node[first + p + lane]))),
                          " is turned inside out: the determinant of its deformation since the "
                          "kernel's reference is ",
                          det[lane], "."));
      }
    }

    /** ∂v/∂X of a block, and columns of F⁻ᵀ: current ones of @p shape, or of @p deformation. */
    template <int dim>
    const double *find_motion(const Stencils &shape, const unsigned int first,
                              const unsigned int last, const double *position,
                              const double *velocity, BlockMatrices &velocity_gradient,
                              BlockMatrices &deformation, BlockVectors *const residual)
    {
      const unsigned int n = last - first;
      const bool is_current = shape.inverse_deformation_is_current;
      const double *const current =
          is_current ? shape.inverse_deformation.data() + 3 * node_stride * std::size_t(first)
                     : nullptr;
      BlockVectors none;
      const auto gather = [&](const auto with_deformation, const auto with_residual)
      {
        gather_gradients<dim, with_deformation(), with_residual()>(
            shape, first, last, position, velocity, velocity_gradient, deformation,
            with_residual() ? *residual : none);
      };
      constexpr std::true_type yes;
      constexpr std::false_type no;
      if (is_current)
        residual != nullptr ? gather(no, yes) : gather(no, no);
      else
      {
        residual != nullptr ? gather(yes, yes) : gather(yes, no);
        set_undeformed_rows(shape, first, last, deformation);
      }
      if (n < padded_to_lanes(n))
      {
        velocity_gradient.fill(n, padded_to_lanes(n), 0.);
        deformation.fill(n, padded_to_lanes(n), 1.);
        if (is_current)
          std::copy_n(current, 3 * node_stride * std::size_t(n), deformation.columns[0][0]);
      }
      if (!is_current)
        invert_deformation<dim>(shape, first, last, position, deformation);
      return is_current && n == padded_to_lanes(n) ? current : deformation.columns[0][0];
    }

    /** H, the increment of the displacement differentiated at the end of the step. */
    TOMBOLO_ALWAYS_INLINE Matrix3<Lanes> increment_at(const BlockMatrices &velocity_gradient,
                                                      const double *inverse_f, const unsigned int p,
                                                      const double time_increment)
    {
      Matrix3<Lanes> increment =
          multiply(load_columns(velocity_gradient.columns[p][0]),
                   transposed(load_columns(inverse_f + 3 * node_stride * p)));
      for (Lanes &entry : increment.entry)
        entry *= time_increment;
      return increment;
    }

    /** Multiplies @p deformation, unless it is null, with that of the step, (1 - H)⁻¹. */
    template <int dim>
    void follow_motion(const BlockMatrices &velocity_gradient, const double *inverse_f,
                       const unsigned int first, const unsigned int last,
                       const double time_increment, std::vector<Tensor<2, dim>> *const deformation)
    {
      const unsigned int n = deformation == nullptr ? 0 : last - first;
      for (unsigned int p = 0; p < n; p += n_lanes)
      {
        Matrix3<Lanes> backwards = increment_at(velocity_gradient, inverse_f, p, time_increment);
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
            backwards(i, j) = (i == j ? 1. : 0.) - backwards(i, j);
        Lanes det;
        const Matrix3<Lanes> forwards = inverse(backwards, det);
        alignas(64) double step_deformation[dim][dim][n_lanes];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            store_lanes(forwards(i, j), step_deformation[i][j]);
        for (unsigned int lane = 0; lane < n_lanes && p + lane < n; ++lane)
        {
          Tensor<2, dim> &now = (*deformation)[first + p + lane];
          const Tensor<2, dim> before = now;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
            {
              double sum = 0;
              for (unsigned int k = 0; k < dim; ++k)
                sum += step_deformation[i][k][lane] * before[k][j];
              now[i][j] = sum;
            }
        }
      }
    }
  } // namespace ParticleBlock
} // namespace tombolo
