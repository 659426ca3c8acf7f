// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/nodal_smoothing.h>

#include <tombolo/approximation/fetch_ahead.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>

#include <cmath>

namespace tombolo
{
  namespace NodalSmoothing
  {
    namespace
    {
      /** A position by components in vectors: an offset, broadcast, is a load and a subtraction. */
      class Axes
      {
      public:
        explicit Axes(const double *position)
            : x(broadcast_in_register(position[0])), y(broadcast_in_register(position[1])),
              z(broadcast_in_register(position[2]))
        {}

        TOMBOLO_ALWAYS_INLINE NodeLanes offset(const double *other, const unsigned int d) const
        {
          const NodeLanes &component = d == 0 ? x : d == 1 ? y : z;
          return NodeLanes(other[d]) - component;
        }

      private:
        NodeLanes x, y, z;
      };

      /** Σ y and Σ y ⊗ (x_J - x_I), by columns. */
      struct Moments
      {
        NodeLanes sum = 0., x = 0., y = 0., z = 0.;

        TOMBOLO_ALWAYS_INLINE void add(const NodeLanes &value, const double *other,
                                       const Axes &axes)
        {
          sum += value;
          x += value * axes.offset(other, 0);
          y += value * axes.offset(other, 1);
          z += value * axes.offset(other, 2);
        }
      };

      [[noreturn]] void throw_singular(const double *position)
      {
        throw RunError(
            as_text("The deformation since the kernel's reference is singular at the particle at (",
                    position[0], ", ", position[1], ", ", position[2], ")."));
      }

      /** Inverts F given by columns, and writes the rows of the inverse. Returns det F. */
      template <int dim>
      TOMBOLO_ALWAYS_INLINE double store_inverse(const NodeLanes &a, const NodeLanes &b,
                                                 const NodeLanes &column_z, double *inverse)
      {
        const NodeLanes c = dim == 3 ? column_z : node_of(0., 0., 1.);
        const NodeLanes bc = cross_product(b, c);
        const NodeLanes product = a * bc;
        const double det = product[0] + product[1] + product[2];
        const double factor = 1. / det;
        store_node(bc * factor, inverse);
        store_node(cross_product(c, a) * factor, inverse + node_stride);
        store_node(cross_product(a, b) * factor, inverse + 2 * node_stride);
        return det;
      }

      /** F of one particle, by columns. */
      struct Deformation
      {
        NodeLanes x = 0., y = 0., z = 0.;

        TOMBOLO_ALWAYS_INLINE void add(const NodeLanes &offset, const double *gradient)
        {
          x += offset * gradient[0];
          y += offset * gradient[1];
          z += offset * gradient[2];
        }

        void set_identity()
        {
          x = node_of(1., 0., 0.);
          y = node_of(0., 1., 0.);
          z = node_of(0., 0., 1.);
        }
      };
    } // namespace

    void scatter_row(const Stencils::Row &row, const NodeLanes &value, double *result)
    {
      for (unsigned int k = 0; k < row.size; ++k)
      {
        double *const target = node(result, row.neighbour[k]);
        store_node(load_node(target) + value * row.value[k], target);
      }
    }

    NodeLanes gather_row(const Stencils::Row &row, const double *field)
    {
      NodeLanes sum = 0.;
      for (unsigned int k = 0; k < row.size; ++k)
        sum += load_node(node(field, row.neighbour[k])) * row.value[k];
      return sum;
    }

    namespace
    {
      /** Fills the inverse deformation, and calls @p check(row, det F). */
      template <int dim, typename Check>
      void invert_deformation(const double *position, Stencils &shape, const Check &check)
      {
        shape.inverse_deformation.resize_fast(3 * node_stride * shape.particle_node.size());
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          fetch_ahead(shape, row, position);
          fetch_coefficients_ahead<false, true>(shape, row);
          const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
          // Two chains of sums hide the time that an addition takes.
          Deformation f, odd;
          const Stencils::Row stencil = shape.row_of_gradients(row);
          const auto add = [&](const unsigned int k, Deformation &sum)
          {
            sum.add(load_node(node(position, stencil.neighbour[k])) - centre,
                    stencil.gradient + k * Stencils::n_gradient);
          };
          unsigned int k = 0;
          for (; k + 1 < stencil.size; k += 2)
          {
            add(k, f);
            add(k + 1, odd);
          }
          if (k < stencil.size)
            add(k, f);
          f.x += odd.x;
          f.y += odd.y;
          f.z += odd.z;
          if (shape.is_undeformed(row))
            f.set_identity();
          check(row, store_inverse<dim>(f.x, f.y, f.z,
                                        shape.inverse_deformation.data() +
                                            3 * node_stride * std::size_t(row)));
        }
      }
    } // namespace

    template <int dim>
    void update_inverse_deformation(const double *position, Stencils &shape)
    {
      invert_deformation<dim>(position, shape,
                              [&](const unsigned int row, const double det)
                              {
                                if (!(std::abs(det) > 1e-12))
                                  throw_singular(node(position, shape.particle_node[row]));
                              });
      shape.inverse_deformation_is_current = true;
    }

    template <int dim>
    void try_inverse_deformation(const double *position, Stencils &shape)
    {
      if (shape.inverse_deformation_is_current)
        return;
      bool are_positive = true;
      invert_deformation<dim>(position, shape,
                              [&](const unsigned int, const double det)
                              { are_positive = are_positive && det > 0.; });
      shape.inverse_deformation_is_current = are_positive;
    }

    void scatter(const Stencils &shape, const double *row_mass, const double *velocity,
                 double *momentum)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        fetch_ahead(shape, row, momentum);
        fetch_coefficients_ahead<true, false>(shape, row);
        const NodeLanes weighted =
            load_node(node(row_mass, row)) * load_node(node(velocity, shape.particle_node[row]));
        scatter_row(shape.row_of_values(row), weighted, momentum);
      }
    }

    void gather(const Stencils &shape, const double *row_weight, const double *field,
                double *result)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        fetch_ahead(shape, row, field);
        fetch_coefficients_ahead<true, false>(shape, row);
        const NodeLanes sum = gather_row(shape.row_of_values(row), field);
        double *const target = node(result, shape.particle_node[row]);
        store_node(load_node(target) + load_node(node(row_weight, row)) * sum, target);
      }
    }

    void gather_motion(const Stencils &shape, const double *row_weight, const double *row_mass,
                       const double *velocity, const double *acceleration,
                       const double velocity_time_step, const double position_time_step,
                       double *unsmoothed_velocity, double *position, double *momentum)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        fetch_ahead(shape, row, acceleration, velocity);
        fetch_coefficients_ahead<true, false>(shape, row);
        const Stencils::Row stencil = shape.row_of_values(row);
        // Two chains of sums hide the time that an addition takes.
        NodeLanes sum_acceleration = 0., sum_velocity = 0.;
        NodeLanes odd_acceleration = 0., odd_velocity = 0.;
        unsigned int k = 0;
        for (; k + 1 < stencil.size; k += 2)
        {
          const unsigned int even = stencil.neighbour[k], odd = stencil.neighbour[k + 1];
          sum_acceleration += load_node(node(acceleration, even)) * stencil.value[k];
          sum_velocity += load_node(node(velocity, even)) * stencil.value[k];
          odd_acceleration += load_node(node(acceleration, odd)) * stencil.value[k + 1];
          odd_velocity += load_node(node(velocity, odd)) * stencil.value[k + 1];
        }
        if (k < stencil.size)
        {
          sum_acceleration +=
              load_node(node(acceleration, stencil.neighbour[k])) * stencil.value[k];
          sum_velocity += load_node(node(velocity, stencil.neighbour[k])) * stencil.value[k];
        }
        sum_acceleration += odd_acceleration;
        sum_velocity += odd_velocity;
        const NodeLanes weight = load_node(node(row_weight, row));
        const NodeLanes velocity_increment = sum_acceleration * velocity_time_step;
        double *const own_velocity = node(unsmoothed_velocity, shape.particle_node[row]);
        double *const own_position = node(position, shape.particle_node[row]);
        const NodeLanes new_velocity = load_node(own_velocity) + weight * velocity_increment;
        store_node(new_velocity, own_velocity);
        store_node(load_node(own_position) +
                       weight * (sum_velocity + velocity_increment) * position_time_step,
                   own_position);
        if (momentum != nullptr)
        {
          const NodeLanes weighted = load_node(node(row_mass, row)) * new_velocity;
          scatter_row(stencil, weighted, momentum);
        }
      }
    }

    namespace
    {
      TOMBOLO_ALWAYS_INLINE void scatter_affine_row(const Stencils &shape, const unsigned int row,
                                                    const double *row_mass, const double *velocity,
                                                    double *momentum)
      {
        const double *const reference = shape.reference_position.data();
        fetch_ahead(shape, row, velocity, reference, momentum);
        fetch_coefficients_ahead<true, true>(shape, row);
        const Stencils::Row stencil = shape.row(row);
        const NodeLanes own_velocity = load_node(node(velocity, shape.particle_node[row]));
        // Relative to the particle itself: Σ ∇φ = 0 only to round-off.
        Deformation h;
        for (unsigned int k = 0; k < stencil.size; ++k)
          h.add(load_node(node(velocity, stencil.neighbour[k])) - own_velocity,
                stencil.gradient + k * Stencils::n_gradient);
        const NodeLanes mass = load_node(node(row_mass, row));
        const NodeLanes weighted = mass * own_velocity;
        const NodeLanes slope_x = mass * h.x, slope_y = mass * h.y, slope_z = mass * h.z;
        const Axes axes(node(reference, shape.particle_node[row]));
        for (unsigned int k = 0; k < stencil.size; ++k)
        {
          const unsigned int neighbour = stencil.neighbour[k];
          const double *const other = node(reference, neighbour);
          const NodeLanes value = weighted + slope_x * axes.offset(other, 0) +
                                  slope_y * axes.offset(other, 1) + slope_z * axes.offset(other, 2);
          double *const target = node(momentum, neighbour);
          store_node(load_node(target) + value * stencil.value[k], target);
        }
      }

      TOMBOLO_ALWAYS_INLINE void gather_affine_row(const Stencils &shape, const unsigned int row,
                                                   const double *row_mass, const double *field,
                                                   double *result)
      {
        const double *const reference = shape.reference_position.data();
        fetch_ahead(shape, row, field, reference, result);
        fetch_coefficients_ahead<true, true>(shape, row);
        const Stencils::Row stencil = shape.row(row);
        const Axes axes(node(reference, shape.particle_node[row]));
        // Two chains of sums hide the time that an addition takes.
        Moments even, odd;
        const auto value_of = [&](const unsigned int k)
        { return load_node(node(field, stencil.neighbour[k])) * stencil.value[k]; };
        unsigned int k = 0;
        for (; k + 1 < stencil.size; k += 2)
        {
          even.add(value_of(k), node(reference, stencil.neighbour[k]), axes);
          odd.add(value_of(k + 1), node(reference, stencil.neighbour[k + 1]), axes);
        }
        if (k < stencil.size)
          even.add(value_of(k), node(reference, stencil.neighbour[k]), axes);
        const NodeLanes mass = load_node(node(row_mass, row));
        const NodeLanes slope_x = mass * (even.x + odd.x), slope_y = mass * (even.y + odd.y),
                        slope_z = mass * (even.z + odd.z);
        // The velocity gradient was taken of differences to the particle's own velocity, so what
        // is added to its neighbours is subtracted from it: exact also where Σ ∇φ is only zero to
        // round-off.
        NodeLanes given = 0.;
        for (k = 0; k < stencil.size; ++k)
        {
          const double *const gradient = stencil.gradient + k * Stencils::n_gradient;
          const NodeLanes share =
              slope_x * gradient[0] + slope_y * gradient[1] + slope_z * gradient[2];
          double *const target = node(result, stencil.neighbour[k]);
          store_node(load_node(target) + share, target);
          given += share;
        }
        double *const target = node(result, shape.particle_node[row]);
        store_node(load_node(target) + mass * (even.sum + odd.sum) - given, target);
      }

      /** Calls @p use with some rows, or null: all. */
      template <typename Use>
      TOMBOLO_ALWAYS_INLINE void for_rows(const Stencils &shape,
                                          const std::vector<unsigned int> *rows, const Use &use)
      {
        const std::size_t n = rows == nullptr ? shape.n_particles() : rows->size();
        for (std::size_t k = 0; k < n; ++k)
          use(rows == nullptr ? static_cast<unsigned int>(k) : (*rows)[k]);
      }
    } // namespace

    void scatter_affine(const Stencils &shape, const double *row_mass, const double *velocity,
                        double *momentum, const std::vector<unsigned int> *rows)
    {
      for_rows(shape, rows,
               [&](const unsigned int row)
               { scatter_affine_row(shape, row, row_mass, velocity, momentum); });
    }

    void gather_affine(const Stencils &shape, const double *row_mass, const double *field,
                       double *result, const std::vector<unsigned int> *rows)
    {
      for_rows(shape, rows,
               [&](const unsigned int row)
               { gather_affine_row(shape, row, row_mass, field, result); });
    }

    template void update_inverse_deformation<2>(const double *, Stencils &);
    template void update_inverse_deformation<3>(const double *, Stencils &);
    template void try_inverse_deformation<2>(const double *, Stencils &);
    template void try_inverse_deformation<3>(const double *, Stencils &);
  } // namespace NodalSmoothing
} // namespace tombolo
