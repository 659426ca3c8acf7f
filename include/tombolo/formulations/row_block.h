// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/row_deformation.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <cstddef>

namespace tombolo
{
  /** Sums over the rows of a block of points: from nodes to matrices at points, and back. Nodal
   * arrays are at the address of local node 0, node_stride doubles a node. */
  namespace RowBlock
  {
    using NodalSmoothing::node;

    /** Of n_lanes points one after the other, each with three columns. */
    TOMBOLO_ALWAYS_INLINE Matrix3<Lanes> load_columns(const double *columns)
    {
      Matrix3<Lanes> result;
      TOMBOLO_UNROLL
      for (unsigned int j = 0; j < 3; ++j)
      {
        NodeLanes column[n_lanes];
        TOMBOLO_UNROLL
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          column[lane] = load_node(columns + (3 * lane + j) * node_stride);
        Lanes component[3];
        nodes_to_lanes(column, component);
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i < 3; ++i)
          result(i, j) = component[i];
      }
      return result;
    }

    TOMBOLO_ALWAYS_INLINE void store_columns(const Matrix3<Lanes> &matrices, double *columns)
    {
      TOMBOLO_UNROLL
      for (unsigned int j = 0; j < 3; ++j)
      {
        const Lanes component[3] = {matrices(0, j), matrices(1, j), matrices(2, j)};
        NodeLanes column[n_lanes];
        lanes_to_nodes(component, column);
        TOMBOLO_UNROLL
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          store_node(column[lane], columns + (3 * lane + j) * node_stride);
      }
    }

    TOMBOLO_ALWAYS_INLINE Matrix3<Lanes> transposed(const Matrix3<Lanes> &matrix)
    {
      Matrix3<Lanes> result;
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < 3; ++i)
        TOMBOLO_UNROLL
      for (unsigned int j = 0; j < 3; ++j)
        result(i, j) = matrix(j, i);
      return result;
    }

    /** The sums of @p value ⊗ ∇φ over a row, less @p origin ⊗ Σ∇φ, as columns. */
    TOMBOLO_ALWAYS_INLINE void add_row(const Stencils::Row &row, const double *value,
                                       const NodeLanes &origin, NodeLanes (&columns)[3])
    {
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const double *const gradient = row.gradient + k * Stencils::n_gradient;
        const NodeLanes offset = load_node(node(value, row.neighbour[k])) - origin;
        TOMBOLO_UNROLL
        for (unsigned int d = 0; d < 3; ++d)
          columns[d] += offset * gradient[d];
      }
    }

    /** Of n_lanes rows from @p first on, of which the first @p n exist: F = Σ (x_J - x_I) ⊗ ∇φ_J
     * and Σ v_J ⊗ ∇φ_J; one and zero of others. */
    template <int dim>
    TOMBOLO_ALWAYS_INLINE void gather_gradients(const Stencils &stencils, const std::size_t first,
                                                const unsigned int n, const double *position,
                                                const double *velocity, Matrix3<Lanes> &deformation,
                                                Matrix3<Lanes> &velocity_gradient)
    {
      alignas(64) double velocity_columns[n_lanes][3][node_stride] = {};
      alignas(64) double deformation_columns[n_lanes][3][node_stride] = {};
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        if (lane >= n)
        {
          for (unsigned int j = 0; j < 3; ++j)
            deformation_columns[lane][j][j] = 1.;
          continue;
        }
        const auto number = static_cast<unsigned int>(first + lane);
        const Stencils::Row row = stencils.row_of_gradients(number);
        NodeLanes h[3] = {0., 0., 0.}, f[3] = {0., 0., 0.};
        add_row(row, velocity, NodeLanes(0.), h);
        add_row(row, position, load_node(node(position, stencils.particle_node[number])), f);
        for (unsigned int j = 0; j < 3; ++j)
        {
          store_node(h[j], velocity_columns[lane][j]);
          store_node(f[j], deformation_columns[lane][j]);
        }
      }
      deformation = load_columns(deformation_columns[0][0]);
      if constexpr (dim == 2)
        deformation(2, 2) = 1.;
      velocity_gradient = load_columns(velocity_columns[0][0]);
    }

    /** Conduction at a point with this row: subtracts c (F⁻ᵀ∇θ) · (F⁻ᵀ∇φ_J) from slot 0 of @p
     * heat_rate at each neighbour J, c = V k by @p factor, a function of det F; F is the identity
     * where the point @p is_undeformed. */
    template <int dim, typename Factor>
    void conduct(const Stencils &stencils, const unsigned int number, const bool is_undeformed,
                 const NodalVector &position, const NodalVector &temperature, const Factor &factor,
                 NodalVector &heat_rate)
    {
      const Stencils::Row row = stencils.row_of_gradients(number);
      const unsigned int own = stencils.particle_node[number];
      NodeLanes gradient = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
        gradient += load_node(row.gradient + k * Stencils::n_gradient) *
                    (*temperature.node(row.neighbour[k]) - *temperature.node(own));
      dealii::Tensor<1, dim> reference_gradient;
      for (unsigned int a = 0; a < dim; ++a)
        reference_gradient[a] = gradient[a];
      dealii::Tensor<2, dim> inverse_deformation = dealii::unit_symmetric_tensor<dim>();
      if (stencils.inverse_deformation_is_current)
        inverse_deformation = inverse_row_deformation<dim>(stencils, number);
      else if (!is_undeformed)
        inverse_deformation = invert(row_deformation<dim>(stencils, number, position));
      // The flux k F⁻ᵀ∇θ, and F⁻¹ of it for the gradients of the reference.
      const dealii::Tensor<1, dim> flux =
          factor(1. / determinant(inverse_deformation)) *
          (inverse_deformation * (transpose(inverse_deformation) * reference_gradient));
      NodeLanes padded = 0.;
      for (unsigned int a = 0; a < dim; ++a)
        padded[a] = flux[a];
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const NodeLanes product = padded * load_node(row.gradient + k * Stencils::n_gradient);
        *heat_rate.node(row.neighbour[k]) -= product[0] + product[1] + product[2];
      }
    }

    /** Subtracts K ∇φ at the neighbours of a row, K given by its columns. */
    TOMBOLO_ALWAYS_INLINE void subtract_row(const Stencils::Row &row, const double *columns,
                                            double *target)
    {
      NodeLanes column[3];
      for (unsigned int j = 0; j < 3; ++j)
        column[j] = load_node(columns + j * node_stride);
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const double *const gradient = row.gradient + k * Stencils::n_gradient;
        double *const at = node(target, row.neighbour[k]);
        store_node(load_node(at) - (column[0] * gradient[0] + column[1] * gradient[1] +
                                    column[2] * gradient[2]),
                   at);
      }
    }

    /** The same, and φ times @p vector at the neighbours, whose opposite node @p own gets. */
    TOMBOLO_ALWAYS_INLINE void subtract_row(const Stencils::Row &row, const double *columns,
                                            const double *vector, const unsigned int own,
                                            double *target)
    {
      NodeLanes column[3];
      for (unsigned int j = 0; j < 3; ++j)
        column[j] = load_node(columns + j * node_stride);
      const NodeLanes node_vector = load_node(vector);
      NodeLanes all = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const double *const gradient = row.gradient + k * Stencils::n_gradient;
        double *const at = node(target, row.neighbour[k]);
        const NodeLanes share = row.value[k] * node_vector;
        store_node(load_node(at) - (column[0] * gradient[0] + column[1] * gradient[1] +
                                    column[2] * gradient[2] + share),
                   at);
        all += share;
      }
      double *const at = node(target, own);
      store_node(load_node(at) + all, at);
    }
  } // namespace RowBlock
} // namespace tombolo
