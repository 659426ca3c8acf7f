#include <tombolo/formulations/particle_force.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/vectorization.h>
#include <tombolo/materials/kinematics.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace tombolo
{
  namespace ParticleForce
  {
    namespace
    {
      /** Particles treated together: their ∇φ, read for the gradients, are still in the
       * second-level cache when the forces need them, and one virtual call of the material serves
       * them all. */
      constexpr unsigned int block_size = 4 * n_lanes;

      const double *node(const double *field, const unsigned int local)
      {
        return field + static_cast<std::size_t>(local) * n_slots;
      }

      double *node(double *field, const unsigned int local)
      {
        return field + static_cast<std::size_t>(local) * n_slots;
      }

      /** Matrices of a block, as arrays over its particles: entry (i, j) of particle p is
       * [3 i + j][p]. */
      using BlockMatrices = std::array<std::array<double, block_size>, 9>;

      void store_columns(const NodeLanes columns[3], const unsigned int place,
                         BlockMatrices &matrices)
      {
        for (unsigned int j = 0; j < 3; ++j)
          for (unsigned int i = 0; i < 3; ++i)
            matrices[3 * i + j][place] = columns[j][i];
      }

      /** ∂v/∂X and, where asked for, F = ∂x/∂X of the particles of a block. */
      template <bool with_deformation>
      void gather_gradients(const ShapeFunctions &shape, const unsigned int first,
                            const unsigned int last, const double *position, const double *velocity,
                            BlockMatrices &velocity_gradient, BlockMatrices &deformation)
      {
        for (unsigned int row = first; row < last; ++row)
        {
          const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
          NodeLanes h[3] = {0., 0., 0.};
          NodeLanes f[3] = {0., 0., 0.};
          for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
          {
            const unsigned int neighbour = shape.neighbour[entry];
            const double *const gradient = shape.gradient.data() + entry * n_slots;
            const NodeLanes v = load_node(node(velocity, neighbour));
            for (unsigned int d = 0; d < 3; ++d)
              h[d] += v * gradient[d];
            if constexpr (with_deformation)
            {
              const NodeLanes offset = load_node(node(position, neighbour)) - own_position;
              for (unsigned int d = 0; d < 3; ++d)
                f[d] += offset * gradient[d];
            }
          }
          store_columns(h, row - first, velocity_gradient);
          if constexpr (with_deformation)
            store_columns(f, row - first, deformation);
        }
      }

      /** Adds -K ∇φ to the forces of the neighbours of each particle of a block. */
      void scatter_force(const ShapeFunctions &shape, const unsigned int first,
                         const unsigned int last, const BlockMatrices &k, double *force)
      {
        for (unsigned int row = first; row < last; ++row)
        {
          const unsigned int p = row - first;
          NodeLanes column[3];
          for (unsigned int j = 0; j < 3; ++j)
          {
            alignas(32) const double entries[n_slots] = {k[j][p], k[3 + j][p], k[6 + j][p], 0.};
            column[j] = load_node(entries);
          }
          for (std::size_t entry = shape.row_start[row]; entry < shape.row_start[row + 1]; ++entry)
          {
            const double *const gradient = shape.gradient.data() + entry * n_slots;
            double *const target = node(force, shape.neighbour[entry]);
            store_node(load_node(target) - (column[0] * gradient[0] + column[1] * gradient[1] +
                                            column[2] * gradient[2]),
                       target);
          }
        }
      }

      Matrix3<Lanes> load_matrix(const BlockMatrices &matrices, const unsigned int place)
      {
        Matrix3<Lanes> result;
        for (unsigned int c = 0; c < 9; ++c)
          result.entry[c] = load_lanes(matrices[c].data() + place);
        return result;
      }

      void store_matrix(const Matrix3<Lanes> &matrix, const unsigned int place,
                        BlockMatrices &matrices)
      {
        for (unsigned int c = 0; c < 9; ++c)
          store_lanes(matrix.entry[c], matrices[c].data() + place);
      }

      void set_identity(const unsigned int from, const unsigned int to, BlockMatrices &matrices)
      {
        for (unsigned int c = 0; c < 9; ++c)
          std::fill(matrices[c].begin() + from, matrices[c].begin() + to, c % 4 == 0 ? 1. : 0.);
      }

      void set_zero(const unsigned int from, const unsigned int to, BlockMatrices &matrices)
      {
        for (unsigned int c = 0; c < 9; ++c)
          std::fill(matrices[c].begin() + from, matrices[c].begin() + to, 0.);
      }

      /** What ∇φ = 0 says of the deformation of rigid rows is not meant. */
      void set_rigid_rows(const ShapeFunctions &shape, const unsigned int first,
                          const unsigned int last, BlockMatrices &deformation)
      {
        for (auto row = std::lower_bound(shape.rigid_rows.begin(), shape.rigid_rows.end(), first);
             row != shape.rigid_rows.end() && *row < last; ++row)
          set_identity(*row - first, *row - first + 1, deformation);
      }

      /** F⁻¹ of a block: taken from the shape functions where it is current, or made from F. */
      template <int dim>
      void inverse_deformation(const ShapeFunctions &shape, const unsigned int first,
                               const unsigned int last, const double *position,
                               const BlockMatrices &deformation, BlockMatrices &inverse_matrices)
      {
        const unsigned int n = last - first;
        if (shape.inverse_deformation_is_current)
        {
          for (unsigned int p = 0; p < n; ++p)
          {
            const double *const columns =
                shape.inverse_deformation.data() + 3 * n_slots * std::size_t(first + p);
            for (unsigned int i = 0; i < 3; ++i)
              for (unsigned int j = 0; j < 3; ++j)
                inverse_matrices[3 * i + j][p] = columns[j * n_slots + i];
          }
          set_identity(n, block_size, inverse_matrices);
          return;
        }
        for (unsigned int p = 0; p < block_size; p += n_lanes)
        {
          Matrix3<Lanes> f = load_matrix(deformation, p);
          if constexpr (dim == 2)
            f(2, 2) = 1.;
          Lanes det;
          store_matrix(inverse(f, det), p, inverse_matrices);
          if (!all_of(det > 0.))
            for (unsigned int lane = 0; lane < n_lanes && p + lane < n; ++lane)
              if (!(det[lane] > 0.))
              {
                const double *const place = node(position, shape.particle_node[first + p + lane]);
                std::ostringstream message;
                message << "the particle at (" << place[0] << ", " << place[1] << ", " << place[2]
                        << ") is turned inside out: the determinant of its deformation since the "
                           "kernel's reference is "
                        << det[lane] << ".";
                throw RunError(message.str());
              }
        }
      }
    } // namespace

    template <int dim>
    void add_internal_force(ShapeFunctions &shape, const std::vector<double> &initial_volume,
                            const Material &material, const double *position,
                            const double *velocity, const double *temperature,
                            const double time_increment, const BulkViscosity &bulk_viscosity,
                            const PointHeat &point_heat, MaterialPoints &points, double *force)
    {
      const unsigned int n_particles = shape.n_particles();
      alignas(64) BlockMatrices h, f, inverse_f;
      alignas(64) std::array<std::array<double, block_size>, 6> strain;
      alignas(64) std::array<double, block_size> nodal_temperature{}, temperature_increment;

      MaterialBatch batch;
      batch.time_increment = time_increment;
      for (unsigned int c = 0; c < 6; ++c)
        batch.strain_increment[c] = strain[c].data();
      std::vector<double *> internal_variables;
      const std::size_t n_material_fields =
          MaterialPoints::n_standard_fields + material.internal_variables().size();
      for (unsigned int field = MaterialPoints::n_standard_fields; field < n_material_fields;
           ++field)
        for (unsigned int c = 0; c < points.fields()[field].n_components; ++c)
          internal_variables.push_back(points.component(field, c));
      batch.internal_variables = internal_variables;

      double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = points.component(MaterialPoints::stress, c);
      double *const volume = points.component(MaterialPoints::volume, 0);
      double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0);

      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const unsigned int n_padded_points = padded_to_lanes(last - first);
        if (last - first < block_size)
        {
          set_zero(last - first, block_size, h);
          set_identity(last - first, block_size, f);
        }
        if (shape.inverse_deformation_is_current)
          gather_gradients<false>(shape, first, last, position, velocity, h, f);
        else
        {
          gather_gradients<true>(shape, first, last, position, velocity, h, f);
          set_rigid_rows(shape, first, last, f);
        }
        inverse_deformation<dim>(shape, first, last, position, f, inverse_f);

        for (unsigned int p = 0; p < n_padded_points; p += n_lanes)
        {
          Matrix3<Lanes> increment = multiply(load_matrix(h, p), load_matrix(inverse_f, p));
          for (Lanes &entry : increment.entry)
            entry *= time_increment;
          const MotionIncrement<Lanes> motion = motion_increment(increment);
          Lanes rotated[6];
          for (unsigned int c = 0; c < 6; ++c)
            rotated[c] = load_lanes(stress[c] + first + p);
          rotate(motion.spin, rotated);
          for (unsigned int c = 0; c < 6; ++c)
          {
            store_lanes(rotated[c], stress[c] + first + p);
            store_lanes(motion.strain[c], strain[c].data() + p);
          }
          store_lanes(load_lanes(volume_ratio + first + p) * motion.volume_factor,
                      volume_ratio + first + p);
        }

        batch.n = n_padded_points;
        for (unsigned int c = 0; c < 6; ++c)
          batch.stress[c] = stress[c] + first;
        batch.volume_ratio = volume_ratio + first;
        for (std::size_t k = 0; k < internal_variables.size(); ++k)
          batch.internal_variables[k] = internal_variables[k] + first;
        if (point_heat.is_on())
        {
          for (unsigned int row = first; row < last; ++row)
            nodal_temperature[row - first] = *node(temperature, shape.particle_node[row]);
          point_heat.advance(points, first, batch.n, nodal_temperature.data(), time_increment == 0.,
                             temperature_increment.data());
          batch.temperature = point_heat.temperature(points) + first;
          batch.temperature_increment = temperature_increment.data();
        }
        material.update_stress(batch);

        for (unsigned int p = first; p < last; ++p)
          volume[p] = initial_volume[p] * volume_ratio[p];
        if (bulk_viscosity.is_on())
          bulk_viscosity.advance(points, first, batch.n, batch.strain_increment, time_increment);
        for (unsigned int p = 0; p < n_padded_points; p += n_lanes)
        {
          // K = V σ F⁻ᵀ turns gradients of the reference into forces.
          const Matrix3<Lanes> inverse_deformation_gradient = load_matrix(inverse_f, p);
          const Lanes v = load_lanes(volume + first + p);
          Lanes s[6];
          for (unsigned int c = 0; c < 6; ++c)
            s[c] = v * load_lanes(stress[c] + first + p);
          if (bulk_viscosity.is_on())
            for (unsigned int c = 0; c < 3; ++c)
              s[c] -= v * load_lanes(bulk_viscosity.pressure(points) + first + p);
          const unsigned int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
          Matrix3<Lanes> k;
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              k(i, j) = s[place[i][0]] * inverse_deformation_gradient(j, 0) +
                        s[place[i][1]] * inverse_deformation_gradient(j, 1) +
                        s[place[i][2]] * inverse_deformation_gradient(j, 2);
          store_matrix(k, p, h);
        }
        scatter_force(shape, first, last, h, force);
      }
    }

    template <int dim>
    void add_stiffness_action(const ShapeFunctions &shape, const Material &material,
                              const MaterialPoints &points, const double *position,
                              const double *velocity, const double time_step,
                              const BulkViscosity &bulk_viscosity, double *force)
    {
      const unsigned int n_particles = shape.n_particles();
      const double twice_shear = 2. * material.shear_modulus();
      const double lambda = material.bulk_modulus() - twice_shear / 3.;
      const double *const volume = points.component(MaterialPoints::volume, 0);
      alignas(64) BlockMatrices h, f, inverse_f;
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        set_zero(last - first, block_size, h);
        set_identity(last - first, block_size, f);
        gather_gradients<true>(shape, first, last, position, velocity, h, f);
        set_rigid_rows(shape, first, last, f);
        inverse_deformation<dim>(shape, first, last, position, f, inverse_f);
        for (unsigned int p = 0; p < last - first; p += n_lanes)
        {
          const Matrix3<Lanes> inverse_gradient = load_matrix(inverse_f, p);
          const Matrix3<Lanes> gradient = multiply(load_matrix(h, p), inverse_gradient);
          const Lanes trace = gradient(0, 0) + gradient(1, 1) + gradient(2, 2);
          const Lanes v = -load_lanes(volume + first + p); // scatter_force subtracts
          Lanes modulus = lambda;
          if (bulk_viscosity.is_on())
            modulus += 2. / time_step * load_lanes(bulk_viscosity.tangent(points) + first + p);
          Matrix3<Lanes> rate;
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              rate(i, j) = v * (0.5 * twice_shear * (gradient(i, j) + gradient(j, i)) +
                                (i == j ? modulus * trace : Lanes(0.)));
          Matrix3<Lanes> k;
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              k(i, j) = rate(i, 0) * inverse_gradient(j, 0) + rate(i, 1) * inverse_gradient(j, 1) +
                        rate(i, 2) * inverse_gradient(j, 2);
          store_matrix(k, p, h);
        }
        scatter_force(shape, first, last, h, force);
      }
    }

    template <int dim>
    void add_conduction(const ShapeFunctions &shape, const std::vector<double> &initial_volume,
                        const TemperatureTable &conductivity, const MaterialPoints *points,
                        const double *position, const double *of_conductivity,
                        const double *temperature, double *heat_rate)
    {
      if (conductivity.largest() == 0.)
        return;
      const double *const volume =
          points == nullptr ? initial_volume.data() : points->component(MaterialPoints::volume, 0);
      auto next_rigid = shape.rigid_rows.begin();
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const std::size_t begin = shape.row_start[row];
        const std::size_t end = shape.row_start[row + 1];
        if (next_rigid != shape.rigid_rows.end() && *next_rigid == row)
        {
          ++next_rigid; // without ∇φ it conducts nothing
          continue;
        }
        const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
        const double own_temperature = *node(temperature, shape.particle_node[row]);
        NodeLanes gradient = 0.;
        NodeLanes columns[3] = {0., 0., 0.};
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          const unsigned int neighbour = shape.neighbour[entry];
          const double *const of_entry = shape.gradient.data() + entry * n_slots;
          gradient += load_node(of_entry) * (*node(temperature, neighbour) - own_temperature);
          const NodeLanes offset = load_node(node(position, neighbour)) - centre;
          for (unsigned int d = 0; d < 3; ++d)
            columns[d] += offset * of_entry[d];
        }
        // The flux k F⁻ᵀ∇θ, and F⁻¹ of it for the gradients of the reference.
        dealii::Tensor<2, dim> deformation;
        dealii::Tensor<1, dim> of_reference;
        for (unsigned int a = 0; a < dim; ++a)
        {
          of_reference[a] = gradient[a];
          for (unsigned int b = 0; b < dim; ++b)
            deformation[a][b] = columns[b][a];
        }
        const dealii::Tensor<2, dim> inverse_deformation = invert(deformation);
        const double k = conductivity.is_constant()
                             ? conductivity.largest()
                             : conductivity.value(*node(of_conductivity, shape.particle_node[row]));
        const dealii::Tensor<1, dim> flux =
            volume[row] * k *
            (inverse_deformation * (transpose(inverse_deformation) * of_reference));
        NodeLanes padded = 0.;
        for (unsigned int a = 0; a < dim; ++a)
          padded[a] = flux[a];
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          const NodeLanes product = padded * load_node(shape.gradient.data() + entry * n_slots);
          *node(heat_rate, shape.neighbour[entry]) -= product[0] + product[1] + product[2];
        }
      }
    }

    template void add_conduction<2>(const ShapeFunctions &, const std::vector<double> &,
                                    const TemperatureTable &, const MaterialPoints *,
                                    const double *, const double *, const double *, double *);
    template void add_conduction<3>(const ShapeFunctions &, const std::vector<double> &,
                                    const TemperatureTable &, const MaterialPoints *,
                                    const double *, const double *, const double *, double *);
    template void add_internal_force<2>(ShapeFunctions &, const std::vector<double> &,
                                        const Material &, const double *, const double *,
                                        const double *, double, const BulkViscosity &,
                                        const PointHeat &, MaterialPoints &, double *);
    template void add_internal_force<3>(ShapeFunctions &, const std::vector<double> &,
                                        const Material &, const double *, const double *,
                                        const double *, double, const BulkViscosity &,
                                        const PointHeat &, MaterialPoints &, double *);
    template void add_stiffness_action<2>(const ShapeFunctions &, const Material &,
                                          const MaterialPoints &, const double *, const double *,
                                          double, const BulkViscosity &, double *);
    template void add_stiffness_action<3>(const ShapeFunctions &, const Material &,
                                          const MaterialPoints &, const double *, const double *,
                                          double, const BulkViscosity &, double *);
  } // namespace ParticleForce
} // namespace tombolo
