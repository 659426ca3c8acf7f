#include <tombolo/particles/nodal_smoothing.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/vectorization.h>

#include <cmath>
#include <sstream>

namespace tombolo
{
  namespace NodalSmoothing
  {
    namespace
    {
      const double *node(const double *field, const unsigned int local)
      {
        return field + static_cast<std::size_t>(local) * n_slots;
      }

      double *node(double *field, const unsigned int local)
      {
        return field + static_cast<std::size_t>(local) * n_slots;
      }

      /** Inverts F given by columns, and writes the columns of the inverse. */
      template <int dim>
      void store_inverse(const NodeLanes columns[3], double *inverse, const double *place)
      {
        const auto f = [&](const unsigned int i, const unsigned int j) -> double
        {
          if (dim == 2 && (i == 2 || j == 2))
            return i == j ? 1. : 0.;
          return columns[j][i];
        };
        const double c00 = f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1);
        const double c01 = f(1, 2) * f(2, 0) - f(1, 0) * f(2, 2);
        const double c02 = f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0);
        const double det = f(0, 0) * c00 + f(0, 1) * c01 + f(0, 2) * c02;
        if (!(std::abs(det) > 1e-12))
        {
          std::ostringstream message;
          message << "The deformation since the kernel's reference is singular at the particle at ("
                  << place[0] << ", " << place[1] << ", " << place[2] << ").";
          throw RunError(message.str());
        }
        const double r = 1. / det;
        double *const a = inverse;
        double *const b = inverse + n_slots;
        double *const c = inverse + 2 * n_slots;
        a[0] = c00 * r;
        a[1] = c01 * r;
        a[2] = c02 * r;
        a[3] = 0;
        b[0] = (f(0, 2) * f(2, 1) - f(0, 1) * f(2, 2)) * r;
        b[1] = (f(0, 0) * f(2, 2) - f(0, 2) * f(2, 0)) * r;
        b[2] = (f(0, 1) * f(2, 0) - f(0, 0) * f(2, 1)) * r;
        b[3] = 0;
        c[0] = (f(0, 1) * f(1, 2) - f(0, 2) * f(1, 1)) * r;
        c[1] = (f(0, 2) * f(1, 0) - f(0, 0) * f(1, 2)) * r;
        c[2] = (f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0)) * r;
        c[3] = 0;
      }
    } // namespace

    template <int dim>
    void update_inverse_deformation(const double *position, ShapeFunctions &shape)
    {
      shape.inverse_deformation.resize_fast(3 * n_slots * shape.particle_node.size());
      auto next_rigid = shape.rigid_rows.begin();
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
        NodeLanes f[3] = {0., 0., 0.};
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
        {
          const NodeLanes offset = load_node(node(position, shape.neighbour[entry])) - centre;
          const double *const gradient = shape.gradient.data() + entry * n_slots;
          for (unsigned int d = 0; d < 3; ++d)
            f[d] += offset * gradient[d];
        }
        if (next_rigid != shape.rigid_rows.end() && *next_rigid == row)
        {
          for (unsigned int d = 0; d < 3; ++d)
            f[d][d] = 1.;
          ++next_rigid;
        }
        store_inverse<dim>(f, shape.inverse_deformation.data() + 3 * n_slots * std::size_t(row),
                           node(position, shape.particle_node[row]));
      }
      shape.inverse_deformation_is_current = true;
    }

    void scatter(const ShapeFunctions &shape, const double *row_mass, const double *velocity,
                 double *momentum)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const NodeLanes weighted =
            load_node(node(row_mass, row)) * load_node(node(velocity, shape.particle_node[row]));
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
        {
          double *const target = node(momentum, shape.neighbour[entry]);
          store_node(load_node(target) + weighted * shape.value[entry], target);
        }
      }
    }

    void gather(const ShapeFunctions &shape, const double *row_weight, const double *field,
                double *result)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        NodeLanes sum = 0.;
        for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
          sum += load_node(node(field, shape.neighbour[entry])) * shape.value[entry];
        double *const target = node(result, shape.particle_node[row]);
        store_node(load_node(target) + load_node(node(row_weight, row)) * sum, target);
      }
    }

    void gather_motion(const ShapeFunctions &shape, const double *row_weight,
                       const double *row_mass, const double *velocity, const double *acceleration,
                       const double velocity_time_step, const double position_time_step,
                       double *unsmoothed_velocity, double *position, double *momentum)
    {
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const std::size_t begin = shape.row_start[row];
        const std::size_t end = shape.row_start[row + 1];
        NodeLanes sum_acceleration = 0.;
        NodeLanes sum_velocity = 0.;
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          const double value = shape.value[entry];
          const unsigned int neighbour = shape.neighbour[entry];
          sum_acceleration += load_node(node(acceleration, neighbour)) * value;
          sum_velocity += load_node(node(velocity, neighbour)) * value;
        }
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
          for (std::size_t entry = begin; entry < end; ++entry)
          {
            double *const target = node(momentum, shape.neighbour[entry]);
            store_node(load_node(target) + weighted * shape.value[entry], target);
          }
        }
      }
    }

    namespace
    {
      template <int dim, bool with_deformation>
      void scatter_affine(ShapeFunctions &shape, const double *row_mass, const double *position,
                          const double *velocity, double *momentum)
      {
        for (unsigned int row = 0; row < shape.n_particles(); ++row)
        {
          const std::size_t begin = shape.row_start[row];
          const std::size_t end = shape.row_start[row + 1];
          const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
          const NodeLanes own_velocity = load_node(node(velocity, shape.particle_node[row]));
          NodeLanes h[3] = {0., 0., 0.};
          NodeLanes f[3] = {0., 0., 0.};
          for (std::size_t entry = begin; entry < end; ++entry)
          {
            const unsigned int neighbour = shape.neighbour[entry];
            const NodeLanes difference = load_node(node(velocity, neighbour)) - own_velocity;
            const double *const gradient = shape.gradient.data() + entry * n_slots;
            for (unsigned int d = 0; d < 3; ++d)
              h[d] += difference * gradient[d];
            if constexpr (with_deformation)
            {
              // Relative to the particle itself: Σ ∇φ = 0 only to round-off, which a large distance
              // from the origin would multiply.
              const NodeLanes offset = load_node(node(position, neighbour)) - centre;
              for (unsigned int d = 0; d < 3; ++d)
                f[d] += offset * gradient[d];
            }
          }
          double *const inverse = shape.inverse_deformation.data() + 3 * n_slots * std::size_t(row);
          if constexpr (with_deformation)
            store_inverse<dim>(f, inverse, node(position, shape.particle_node[row]));
          const NodeLanes mass = load_node(node(row_mass, row));
          NodeLanes slope[3];
          for (unsigned int j = 0; j < 3; ++j)
          {
            const double *const column = inverse + j * n_slots;
            slope[j] = mass * (h[0] * column[0] + h[1] * column[1] + h[2] * column[2]);
          }
          const NodeLanes weighted = mass * own_velocity;
          for (std::size_t entry = begin; entry < end; ++entry)
          {
            const unsigned int neighbour = shape.neighbour[entry];
            const double *const other = node(position, neighbour);
            const NodeLanes value = weighted + slope[0] * (other[0] - centre[0]) +
                                    slope[1] * (other[1] - centre[1]) +
                                    slope[2] * (other[2] - centre[2]);
            double *const target = node(momentum, neighbour);
            store_node(load_node(target) + value * shape.value[entry], target);
          }
        }
      }
    } // namespace

    template <int dim>
    void scatter_affine(ShapeFunctions &shape, const double *row_mass, const double *position,
                        const double *velocity, double *momentum)
    {
      if (shape.inverse_deformation_is_current)
        scatter_affine<dim, false>(shape, row_mass, position, velocity, momentum);
      else
      {
        shape.inverse_deformation.resize_fast(3 * n_slots * shape.particle_node.size());
        scatter_affine<dim, true>(shape, row_mass, position, velocity, momentum);
        shape.inverse_deformation_is_current = true;
      }
    }

    void gather_affine(const ShapeFunctions &shape, const double *row_mass, const double *position,
                       const double *field, double *result)
    {
      Assert(shape.inverse_deformation_is_current, dealii::ExcInternalError());
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const std::size_t begin = shape.row_start[row];
        const std::size_t end = shape.row_start[row + 1];
        const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
        NodeLanes sum = 0.;
        NodeLanes moment[3] = {0., 0., 0.};
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          const unsigned int neighbour = shape.neighbour[entry];
          const double *const other = node(position, neighbour);
          const NodeLanes value = load_node(node(field, neighbour)) * shape.value[entry];
          sum += value;
          for (unsigned int d = 0; d < 3; ++d)
            moment[d] += value * (other[d] - centre[d]);
        }
        const NodeLanes mass = load_node(node(row_mass, row));
        const double *const inverse =
            shape.inverse_deformation.data() + 3 * n_slots * std::size_t(row);
        // moment F⁻ᵀ, so that it can be applied to the gradients of the reference.
        NodeLanes slope[3];
        for (unsigned int j = 0; j < 3; ++j)
          slope[j] = mass * (moment[0] * inverse[j] + moment[1] * inverse[n_slots + j] +
                             moment[2] * inverse[2 * n_slots + j]);
        // The velocity gradient was taken of differences to the particle's own velocity, so what
        // its neighbours get is taken from it: exact also where Σ ∇φ is only zero to round-off.
        NodeLanes given = 0.;
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          const double *const gradient = shape.gradient.data() + entry * n_slots;
          const NodeLanes share =
              slope[0] * gradient[0] + slope[1] * gradient[1] + slope[2] * gradient[2];
          double *const target = node(result, shape.neighbour[entry]);
          store_node(load_node(target) + share, target);
          given += share;
        }
        double *const target = node(result, shape.particle_node[row]);
        store_node(load_node(target) + mass * sum - given, target);
      }
    }

    template void update_inverse_deformation<2>(const double *, ShapeFunctions &);
    template void update_inverse_deformation<3>(const double *, ShapeFunctions &);
    template void scatter_affine<2>(ShapeFunctions &, const double *, const double *,
                                    const double *, double *);
    template void scatter_affine<3>(ShapeFunctions &, const double *, const double *,
                                    const double *, double *);
  } // namespace NodalSmoothing
} // namespace tombolo
