// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_force.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/logarithmic_points.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/row_block.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
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

        void set(const unsigned int place, const NodeLanes (&of_particle)[3])
        {
          for (unsigned int j = 0; j < 3; ++j)
            store_node(of_particle[j], columns[place][j]);
        }

        /** Particles from ... block_size - 1: @p diagonal times the identity. */
        void fill(const unsigned int from, const unsigned int to, const double diagonal)
        {
          for (unsigned int place = from; place < to; ++place)
            for (unsigned int j = 0; j < 3; ++j)
              for (unsigned int i = 0; i < node_stride; ++i)
                columns[place][j][i] = i == j ? diagonal : 0.;
        }
      };

      /** ∂v/∂X and, where asked for, F = ∂x/∂X of the particles of a block. */
      template <bool with_deformation>
      void gather_gradients(const Stencils &shape, const unsigned int first,
                            const unsigned int last, const double *position, const double *velocity,
                            BlockMatrices &velocity_gradient, BlockMatrices &deformation)
      {
        for (unsigned int row = first; row < last; ++row)
        {
          const NodeLanes own_position = load_node(node(position, shape.particle_node[row]));
          // Two chains of sums hide the time that an addition takes.
          NodeLanes h[3] = {0., 0., 0.}, of_odd[3] = {0., 0., 0.};
          NodeLanes f[3] = {0., 0., 0.};
          const Stencils::Row of_row = shape.row(row);
          const auto add = [&](const unsigned int k, NodeLanes(&sum)[3])
          {
            const unsigned int neighbour = of_row.neighbour[k];
            const double *const gradient = of_row.gradient + k * Stencils::n_gradient;
            const NodeLanes v = load_node(node(velocity, neighbour));
            TOMBOLO_UNROLL
            for (unsigned int d = 0; d < 3; ++d)
              sum[d] += v * gradient[d];
            if constexpr (with_deformation)
            {
              const NodeLanes offset = load_node(node(position, neighbour)) - own_position;
              TOMBOLO_UNROLL
              for (unsigned int d = 0; d < 3; ++d)
                f[d] += offset * gradient[d];
            }
          };
          unsigned int k = 0;
          if constexpr (!with_deformation)
          {
            for (; k + 1 < of_row.size; k += 2)
            {
              add(k, h);
              add(k + 1, of_odd);
            }
            TOMBOLO_UNROLL
            for (unsigned int d = 0; d < 3; ++d)
              h[d] += of_odd[d];
          }
          for (; k < of_row.size; ++k)
            add(k, h);
          velocity_gradient.set(row - first, h);
          if constexpr (with_deformation)
            deformation.set(row - first, f);
        }
      }

      /** Adds -K ∇φ to the forces of the neighbours of each particle of a block. */
      void scatter_force(const Stencils &shape, const unsigned int first, const unsigned int last,
                         const BlockMatrices &k, double *force)
      {
        for (unsigned int row = first; row < last; ++row)
          RowBlock::subtract_row(shape.row(row), k.columns[row - first][0], force);
      }

      /** What ∇φ of some rows says of their deformation is not meant. */
      void set_undeformed_rows(const Stencils &shape, const unsigned int first,
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

      /** ∂v/∂X of a block, and the columns of F⁻ᵀ: those of the shape functions where they are
       * current, or made from F in @p deformation. */
      template <int dim>
      const double *find_motion(const Stencils &shape, const unsigned int first,
                                const unsigned int last, const double *position,
                                const double *velocity, BlockMatrices &velocity_gradient,
                                BlockMatrices &deformation)
      {
        const unsigned int n = last - first;
        const bool is_current = shape.inverse_deformation_is_current;
        const double *const current =
            is_current ? shape.inverse_deformation.data() + 3 * node_stride * std::size_t(first)
                       : nullptr;
        if (is_current)
          gather_gradients<false>(shape, first, last, position, velocity, velocity_gradient,
                                  deformation);
        else
        {
          gather_gradients<true>(shape, first, last, position, velocity, velocity_gradient,
                                 deformation);
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

      using BlockStrains = std::array<std::array<double, block_size>, 6>;

      /** H, the increment of the displacement differentiated at the end of the step. */
      TOMBOLO_ALWAYS_INLINE Matrix3<Lanes> increment_at(const BlockMatrices &velocity_gradient,
                                                        const double *inverse_f,
                                                        const unsigned int p,
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
                         const double time_increment,
                         std::vector<dealii::Tensor<2, dim>> *const deformation)
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
          alignas(64) double of_step[dim][dim][n_lanes];
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              store_lanes(forwards(i, j), of_step[i][j]);
          for (unsigned int lane = 0; lane < n_lanes && p + lane < n; ++lane)
          {
            dealii::Tensor<2, dim> &now = (*deformation)[first + p + lane];
            const dealii::Tensor<2, dim> before = now;
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
              {
                double sum = 0;
                for (unsigned int k = 0; k < dim; ++k)
                  sum += of_step[i][k][lane] * before[k][j];
                now[i][j] = sum;
              }
          }
        }
      }

      /** Strain increments of n_lanes particles at @p p of a block, and what their stress and
       * volume ratio (from @p first on) get from the motion alone: the rotation (eq. 19) and the
       * change of volume. */
      TOMBOLO_ALWAYS_INLINE void apply_motion(const MotionIncrement<Lanes> &motion,
                                              const unsigned int first, const unsigned int p,
                                              double *const (&stress)[6],
                                              double *const volume_ratio, BlockStrains &strain)
      {
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

      TOMBOLO_ALWAYS_INLINE void
      advance_kinematics(const BlockMatrices &velocity_gradient, const double *inverse_f,
                         const unsigned int n_padded_points, const double time_increment,
                         const unsigned int first, double *const (&stress)[6],
                         double *const volume_ratio, BlockStrains &strain)
      {
        for (unsigned int p = 0; p < n_padded_points; p += n_lanes)
          apply_motion(
              motion_increment(increment_at(velocity_gradient, inverse_f, p, time_increment)),
              first, p, stress, volume_ratio, strain);
      }

      /** The same for the logarithmic measure, whose stress is Kirchhoff's until the material has
       * advanced it; @p work_factors go to the material. */
      void advance_logarithmic(const BlockMatrices &velocity_gradient, const double *inverse_f,
                               const unsigned int n_padded_points, const double time_increment,
                               const unsigned int first, const Material &material,
                               const double *temperature, MaterialPoints &points,
                               double *const (&stress)[6], double *const volume_ratio,
                               BlockStrains &strain, double *work_factors)
      {
        alignas(64) double bulk[block_size], shear[block_size];
        material.elastic_moduli(
            n_padded_points, temperature == nullptr ? nullptr : temperature + first, bulk, shear);
        for (unsigned int p = 0; p < n_padded_points; p += n_lanes)
        {
          const MotionIncrement<Lanes> motion = LogarithmicPoints::begin(
              points, first + p, increment_at(velocity_gradient, inverse_f, p, time_increment),
              load_lanes(bulk + p), load_lanes(shear + p));
          apply_motion(motion, first, p, stress, volume_ratio, strain);
          store_lanes(work_factor(motion), work_factors + p);
        }
      }

      /** K = V σ F⁻ᵀ of a block, which turns gradients of the reference into forces; @p pressure is
       * artificial, or null. */
      TOMBOLO_ALWAYS_INLINE void
      find_force_matrices(const double *inverse_f, const unsigned int n_padded_points,
                          const unsigned int first, double *const (&stress)[6],
                          const double *volume, const double *pressure, BlockMatrices &matrices)
      {
        for (unsigned int p = 0; p < n_padded_points; p += n_lanes)
        {
          const Matrix3<Lanes> inverse_transpose = load_columns(inverse_f + 3 * node_stride * p);
          const Lanes v = load_lanes(volume + first + p);
          Lanes s[6];
          for (unsigned int c = 0; c < 6; ++c)
            s[c] = v * load_lanes(stress[c] + first + p);
          if (pressure != nullptr)
            for (unsigned int c = 0; c < 3; ++c)
              s[c] -= v * load_lanes(pressure + first + p);
          const unsigned int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
          Matrix3<Lanes> k;
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              k(i, j) = s[place[i][0]] * inverse_transpose(0, j) +
                        s[place[i][1]] * inverse_transpose(1, j) +
                        s[place[i][2]] * inverse_transpose(2, j);
          store_columns(k, matrices.columns[p][0]);
        }
      }
    } // namespace

    template <int dim>
    void add_internal_force(Stencils &shape, const std::vector<double> &initial_volume,
                            const Material &material, const StrainMeasure measure,
                            const double *position, const double *velocity,
                            const double *temperature, const double time_increment,
                            const BulkViscosity &bulk_viscosity,
                            const PlasticHeating &plastic_heating, MaterialPoints &points,
                            std::vector<dealii::Tensor<2, dim>> *const deformation, double *force)
    {
      const unsigned int n_particles = shape.n_particles();
      const bool is_logarithmic = measure == StrainMeasure::logarithmic;
      BlockMatrices h, f;
      alignas(64) BlockStrains strain;
      alignas(64) double work_factors[block_size];
      alignas(64) std::array<double, block_size> nodal_temperature{}, temperature_increment;

      MaterialBatch batch;
      batch.time_increment = time_increment;
      batch.measure = measure;
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
        const double *const inverse_f =
            find_motion<dim>(shape, first, last, position, velocity, h, f);
        follow_motion(h, inverse_f, first, last, time_increment, deformation);
        if (is_logarithmic)
          advance_logarithmic(h, inverse_f, n_padded_points, time_increment, first, material,
                              plastic_heating.temperature(points), points, stress, volume_ratio,
                              strain, work_factors);
        else
          advance_kinematics(h, inverse_f, n_padded_points, time_increment, first, stress,
                             volume_ratio, strain);

        batch.n = n_padded_points;
        for (unsigned int c = 0; c < 6; ++c)
          batch.stress[c] = stress[c] + first;
        batch.relative_volume = volume_ratio + first;
        batch.volume_ratio = is_logarithmic ? work_factors : batch.relative_volume;
        for (std::size_t k = 0; k < internal_variables.size(); ++k)
          batch.internal_variables[k] = internal_variables[k] + first;
        if (plastic_heating.is_on())
        {
          for (unsigned int row = first; row < last; ++row)
            nodal_temperature[row - first] = *node(temperature, shape.particle_node[row]);
          plastic_heating.advance(points, first, batch.n, nodal_temperature.data(),
                                  time_increment == 0., temperature_increment.data());
          batch.temperature = plastic_heating.temperature(points) + first;
          batch.temperature_increment = temperature_increment.data();
        }
        material.update_stress(batch);
        if (is_logarithmic)
          LogarithmicPoints::complete(points, first, n_padded_points);

        for (unsigned int p = first; p < last; ++p)
          volume[p] = initial_volume[p] * volume_ratio[p];
        if (bulk_viscosity.is_on())
          bulk_viscosity.advance(points, first, batch.n, batch.strain_increment, time_increment);
        find_force_matrices(inverse_f, n_padded_points, first, stress, volume,
                            bulk_viscosity.is_on() ? bulk_viscosity.pressure(points) : nullptr, h);
        scatter_force(shape, first, last, h, force);
      }
    }

    template <int dim>
    void apply_elastic_stiffness(const Stencils &shape, const Material &material,
                                 const StrainMeasure measure, const MaterialPoints &points,
                                 const double *position, const double *velocity,
                                 const double time_step, const BulkViscosity &bulk_viscosity,
                                 double *force)
    {
      const unsigned int n_particles = shape.n_particles();
      const PointStiffness stiffness(material, points, measure);
      const double twice_shear = 2. * material.shear_modulus();
      const double lambda = material.bulk_modulus() - twice_shear / 3.;
      const double *const volume = points.component(MaterialPoints::volume, 0);
      const double *const volume_ratio = points.component(MaterialPoints::volume_ratio, 0);
      BlockMatrices h, f;
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const double *const inverse_f =
            find_motion<dim>(shape, first, last, position, velocity, h, f);
        for (unsigned int p = 0; p < last - first; p += n_lanes)
        {
          const Matrix3<Lanes> inverse_gradient =
              transposed(load_columns(inverse_f + 3 * node_stride * p));
          const Matrix3<Lanes> gradient = multiply(load_columns(h.columns[p][0]), inverse_gradient);
          const Lanes trace = gradient(0, 0) + gradient(1, 1) + gradient(2, 2);
          Lanes v = -load_lanes(volume + first + p); // scatter_force subtracts
          if (measure == StrainMeasure::logarithmic)
            v /= load_lanes(volume_ratio + first + p); // of the Kirchhoff stress
          Lanes modulus = stiffness.is_constant() ? Lanes(lambda) : stiffness.lambda(first + p);
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
          store_columns(k, h.columns[p][0]);
        }
        scatter_force(shape, first, last, h, force);
      }
    }

    template <int dim>
    void add_conduction(const Stencils &shape, const std::vector<double> &initial_volume,
                        const TemperatureTable &conductivity, const MaterialPoints *points,
                        const double *position, const double *of_conductivity,
                        const double *temperature, double *heat_rate)
    {
      if (conductivity.largest() == 0.)
        return;
      const double *const volume =
          points == nullptr ? initial_volume.data() : points->component(MaterialPoints::volume, 0);
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        if (shape.is_rigid(row))
          continue; // without ∇φ it conducts nothing
        const Stencils::Row of_row = shape.row(row);
        const NodeLanes centre = load_node(node(position, shape.particle_node[row]));
        const double own_temperature = *node(temperature, shape.particle_node[row]);
        NodeLanes gradient = 0.;
        NodeLanes columns[3] = {0., 0., 0.};
        for (unsigned int k = 0; k < of_row.size; ++k)
        {
          const unsigned int neighbour = of_row.neighbour[k];
          const double *const of_entry = of_row.gradient + k * Stencils::n_gradient;
          gradient += load_node(of_entry) * (*node(temperature, neighbour) - own_temperature);
          const NodeLanes offset = load_node(node(position, neighbour)) - centre;
          for (unsigned int d = 0; d < 3; ++d)
            columns[d] += offset * of_entry[d];
        }
        // The flux k F⁻ᵀ∇θ, and F⁻¹ of it for the gradients of the reference.
        const bool is_undeformed = shape.is_undeformed(row);
        dealii::Tensor<2, dim> deformation;
        dealii::Tensor<1, dim> of_reference;
        for (unsigned int a = 0; a < dim; ++a)
        {
          of_reference[a] = gradient[a];
          for (unsigned int b = 0; b < dim; ++b)
            deformation[a][b] = is_undeformed ? (a == b ? 1. : 0.) : columns[b][a];
        }
        const dealii::Tensor<2, dim> inverse_deformation = invert(deformation);
        const double of_row_conductivity =
            conductivity.is_constant()
                ? conductivity.largest()
                : conductivity.value(*node(of_conductivity, shape.particle_node[row]));
        const dealii::Tensor<1, dim> flux =
            volume[row] * of_row_conductivity *
            (inverse_deformation * (transpose(inverse_deformation) * of_reference));
        NodeLanes padded = 0.;
        for (unsigned int a = 0; a < dim; ++a)
          padded[a] = flux[a];
        for (unsigned int k = 0; k < of_row.size; ++k)
        {
          const NodeLanes product = padded * load_node(of_row.gradient + k * Stencils::n_gradient);
          *node(heat_rate, of_row.neighbour[k]) -= product[0] + product[1] + product[2];
        }
      }
    }

    template void add_conduction<2>(const Stencils &, const std::vector<double> &,
                                    const TemperatureTable &, const MaterialPoints *,
                                    const double *, const double *, const double *, double *);
    template void add_conduction<3>(const Stencils &, const std::vector<double> &,
                                    const TemperatureTable &, const MaterialPoints *,
                                    const double *, const double *, const double *, double *);
    template void add_internal_force<2>(Stencils &, const std::vector<double> &, const Material &,
                                        StrainMeasure, const double *, const double *,
                                        const double *, double, const BulkViscosity &,
                                        const PlasticHeating &, MaterialPoints &,
                                        std::vector<dealii::Tensor<2, 2>> *, double *);
    template void add_internal_force<3>(Stencils &, const std::vector<double> &, const Material &,
                                        StrainMeasure, const double *, const double *,
                                        const double *, double, const BulkViscosity &,
                                        const PlasticHeating &, MaterialPoints &,
                                        std::vector<dealii::Tensor<2, 3>> *, double *);
    template void apply_elastic_stiffness<2>(const Stencils &, const Material &, StrainMeasure,
                                             const MaterialPoints &, const double *, const double *,
                                             double, const BulkViscosity &, double *);
    template void apply_elastic_stiffness<3>(const Stencils &, const Material &, StrainMeasure,
                                             const MaterialPoints &, const double *, const double *,
                                             double, const BulkViscosity &, double *);
  } // namespace ParticleForce
} // namespace tombolo
