// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_force.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>
#include <tombolo/formulations/row_stiffness.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <memory>
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
    } // namespace

    template <int dim>
    void add_internal_force(PartPoints &part, const Stencils &shape,
                            const std::vector<double> &initial_volume, const MechanicalInput &input,
                            std::vector<dealii::Tensor<2, dim>> *const deformation,
                            NodalVector &force)
    {
      const unsigned int n_particles = shape.n_particles();
      BlockMatrices h, f;
      PointSweep<block_size> sweep(part, input.time_increment);
      double *const volume = part.points().component(MaterialPoints::volume, 0);
      const double *const ratio = part.points().component(MaterialPoints::volume_ratio, 0);
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const unsigned int n = padded_to_lanes(last - first);
        const double *const inverse_f = find_motion<dim>(shape, first, last, input.position->data(),
                                                         input.velocity->data(), h, f);
        follow_motion(h, inverse_f, first, last, input.time_increment, deformation);
        sweep.begin(first, n);
        for (unsigned int p = 0; p < n; p += n_lanes)
          sweep.move(p, sweep.motion(p, increment_at(h, inverse_f, p, input.time_increment)));
        if (part.heating().is_on())
          for (unsigned int row = first; row < last; ++row)
            sweep.nodal_temperature[row - first] =
                *input.temperature->node(shape.particle_node[row]);
        sweep.update_stress();
        for (unsigned int p = first; p < last; ++p)
          volume[p] = initial_volume[p] * ratio[p];
        sweep.update_viscosity();
        // K = V σ F⁻ᵀ turns gradients of the reference into forces.
        for (unsigned int p = 0; p < n; p += n_lanes)
        {
          Lanes stress[6];
          part.integrate_stress(first + p, stress);
          store_columns(
              multiply(symmetric_matrix(stress), load_columns(inverse_f + 3 * node_stride * p)),
              h.columns[p][0]);
        }
        scatter_force(shape, first, last, h, force.data());
      }
    }

    template <int dim>
    void apply_elastic_stiffness(const PartPoints &part, const Stencils &shape,
                                 const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force)
    {
      const unsigned int n_particles = shape.n_particles();
      const PointStiffness stiffness(part, time_step);
      const double *const volume = part.points().component(MaterialPoints::volume, 0);
      BlockMatrices h, f;
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const double *const inverse_f =
            find_motion<dim>(shape, first, last, position.data(), velocity.data(), h, f);
        for (unsigned int p = 0; p < last - first; p += n_lanes)
        {
          const Matrix3<Lanes> inverse_transpose = load_columns(inverse_f + 3 * node_stride * p);
          Lanes stress[6];
          stiffness.find_stress(
              first + p, multiply(load_columns(h.columns[p][0]), transposed(inverse_transpose)),
              -load_lanes(volume + first + p), stress); // scatter_force() subtracts
          store_columns(multiply(symmetric_matrix(stress), inverse_transpose), h.columns[p][0]);
        }
        scatter_force(shape, first, last, h, force.data());
      }
    }

    template <int dim>
    void find_cell_equations(PartPoints &part, const Stencils &shape,
                             const std::vector<double> &initial_volume,
                             const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take)
    {
      using Stiffness = RowStiffness<dim, 1>;
      const auto stiffness = std::make_unique<Stiffness>(part, false, input.time_increment);
      alignas(64) double temperature[n_lanes];
      typename Stiffness::Gradients gradients;
      for (unsigned int first = 0; first < shape.n_particles(); first += n_lanes)
      {
        const unsigned int n = std::min<unsigned int>(n_lanes, shape.n_particles() - first);
        Matrix3<Lanes> &deformation = gradients.deformation[0];
        RowBlock::gather_gradients<dim>(shape, first, n, input.position->data(),
                                        input.velocity->data(), deformation,
                                        gradients.displacement[0]);
        for (Lanes &entry : gradients.displacement[0].entry)
          entry *= input.time_increment;
        gradients.volume[0] = 0.;
        gradients.is_deformed = 0.;
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          temperature[lane] = 0.;
          if (lane >= n)
            continue;
          gradients.volume[0][lane] = initial_volume[first + lane];
          if (part.heating().is_on())
            temperature[lane] = *input.temperature->node(shape.particle_node[first + lane]);
          if (shape.is_undeformed(first + lane))
            for (unsigned int i = 0; i < 3; ++i)
              for (unsigned int j = 0; j < 3; ++j)
                deformation(i, j)[lane] = i == j ? 1. : 0.;
          else
            gradients.is_deformed[lane] = 1.;
        }
        stiffness->find(first, gradients, temperature);
        for (unsigned int lane = 0; lane < n; ++lane)
          stiffness->hand_over(lane, {{shape.row(first + lane)}}, take);
      }
    }

    template <int dim>
    void add_conduction(const PartPoints &part, const Stencils &shape,
                        const std::vector<double> &initial_volume, const NodalVector &position,
                        const NodalVector &of_conductivity, const NodalVector &temperature,
                        NodalVector &heat_rate)
    {
      const TemperatureTable &conductivity = part.heat()->conductivity();
      if (conductivity.largest() == 0.)
        return;
      const double *const volume = part.has_mechanics()
                                       ? part.points().component(MaterialPoints::volume, 0)
                                       : initial_volume.data();
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        if (shape.is_rigid(row))
          continue; // without ∇φ it conducts nothing
        const double conducted =
            volume[row] *
            (conductivity.is_constant()
                 ? conductivity.largest()
                 : conductivity.value(*of_conductivity.node(shape.particle_node[row])));
        RowBlock::conduct<dim>(
            shape, row, shape.is_undeformed(row), position, temperature,
            [conducted](const double /*det*/) { return conducted; }, heat_rate);
      }
    }

    template void add_internal_force(PartPoints &, const Stencils &, const std::vector<double> &,
                                     const MechanicalInput &, std::vector<dealii::Tensor<2, 2>> *,
                                     NodalVector &);
    template void add_internal_force(PartPoints &, const Stencils &, const std::vector<double> &,
                                     const MechanicalInput &, std::vector<dealii::Tensor<2, 3>> *,
                                     NodalVector &);
    template void apply_elastic_stiffness<2>(const PartPoints &, const Stencils &,
                                             const NodalVector &, const NodalVector &, double,
                                             NodalVector &);
    template void apply_elastic_stiffness<3>(const PartPoints &, const Stencils &,
                                             const NodalVector &, const NodalVector &, double,
                                             NodalVector &);
    template void find_cell_equations<2>(PartPoints &, const Stencils &,
                                         const std::vector<double> &, const MechanicalInput &,
                                         const std::function<void(const CellEquations &)> &);
    template void find_cell_equations<3>(PartPoints &, const Stencils &,
                                         const std::vector<double> &, const MechanicalInput &,
                                         const std::function<void(const CellEquations &)> &);
    template void add_conduction<2>(const PartPoints &, const Stencils &,
                                    const std::vector<double> &, const NodalVector &,
                                    const NodalVector &, const NodalVector &, NodalVector &);
    template void add_conduction<3>(const PartPoints &, const Stencils &,
                                    const std::vector<double> &, const NodalVector &,
                                    const NodalVector &, const NodalVector &, NodalVector &);
  } // namespace ParticleForce
} // namespace tombolo
