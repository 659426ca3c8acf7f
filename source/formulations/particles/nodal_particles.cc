// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/nodal_particles.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>
#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <memory>

namespace tombolo
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
    void gather_gradients(const Stencils &shape, const unsigned int first, const unsigned int last,
                          const double *position, const double *velocity,
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
              throw RunError(
                  as_text("the particle at (", place[0], ", ", place[1], ", ", place[2],
                          ") is turned inside out: the determinant of its deformation since the "
                          "kernel's reference is ",
                          det[lane], "."));
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
        alignas(64) double of_step[dim][dim][n_lanes];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
            store_lanes(forwards(i, j), of_step[i][j]);
        for (unsigned int lane = 0; lane < n_lanes && p + lane < n; ++lane)
        {
          Tensor<2, dim> &now = (*deformation)[first + p + lane];
          const Tensor<2, dim> before = now;
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
  std::vector<double> NodalParticles<dim>::collect_particles(const PartSetup<dim> &setup,
                                                             const double dilation,
                                                             const CellSelection<dim> &is_taken,
                                                             const NodalVector *const volumes)
  {
    std::vector<double> masses =
        set.collect(setup, dilation, is_taken, ParticleSet<dim>::DependentNodes::give_way);
    if (volumes != nullptr)
    {
      std::vector<double> of_particles;
      for (const types::global_dof_index node : set.nodes())
        of_particles.push_back(
            *volumes->node(static_cast<unsigned int>(set.owned_nodes().index_within_set(node))));
      set.set_initial_volumes(of_particles);
      for (std::size_t i = 0; i < masses.size(); ++i)
        masses[i] = setup.material->density() * of_particles[i];
    }
    kernel.reset(set);
    return masses;
  }

  template <int dim>
  void NodalParticles<dim>::create_points(const std::vector<FieldDescription> &further)
  {
    if (!part_points.has_mechanics())
      return;
    part_points.create(set.size(), {}, further);
    std::copy(set.initial_volumes().begin(), set.initial_volumes().end(),
              this->points().component(MaterialPoints::volume, 0));
    part_points.begin_with_volumes(dim);
  }

  template <int dim>
  Point<dim> NodalParticles<dim>::support(const unsigned int i) const
  {
    Point<dim> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = kernel.supports()[std::size_t(i) * node_stride + d];
    return result;
  }

  template <int dim>
  void NodalParticles<dim>::add_internal_force(const MechanicalInput &input, NodalVector &force)
  {
    const Stencils &shape = this->stencils();
    const std::vector<double> &initial_volume = set.initial_volumes();
    const unsigned int n_particles = shape.n_particles();
    BlockMatrices h, f;
    PointSweep<block_size> sweep(part_points, input.time_increment);
    double *const volume = part_points.points().component(MaterialPoints::volume, 0);
    const double *const ratio = part_points.points().component(MaterialPoints::volume_ratio, 0);
    for (unsigned int first = 0; first < n_particles; first += block_size)
    {
      const unsigned int last = std::min(first + block_size, n_particles);
      const unsigned int n = padded_to_lanes(last - first);
      const double *const inverse_f = find_motion<dim>(shape, first, last, input.position->data(),
                                                       input.velocity->data(), h, f);
      follow_motion(h, inverse_f, first, last, input.time_increment,
                    kernel.deformation_of_motion());
      sweep.begin(first, n);
      for (unsigned int p = 0; p < n; p += n_lanes)
        sweep.move(p, sweep.motion(p, increment_at(h, inverse_f, p, input.time_increment)));
      if (part_points.heating().is_on())
        for (unsigned int row = first; row < last; ++row)
          sweep.nodal_temperature[row - first] = *input.temperature->node(shape.particle_node[row]);
      sweep.update_stress();
      for (unsigned int p = first; p < last; ++p)
        volume[p] = initial_volume[p] * ratio[p];
      sweep.update_viscosity();
      // K = V σ F⁻ᵀ turns gradients of the reference into forces.
      for (unsigned int p = 0; p < n; p += n_lanes)
      {
        Lanes stress[6];
        part_points.integrate_stress(first + p, stress);
        store_columns(
            multiply(symmetric_matrix(stress), load_columns(inverse_f + 3 * node_stride * p)),
            h.columns[p][0]);
      }
      scatter_force(shape, first, last, h, force.data());
    }
  }

  template <int dim>
  void NodalParticles<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                    const NodalVector &velocity,
                                                    const double time_step,
                                                    NodalVector &force) const
  {
    const Stencils &shape = this->stencils();
    const unsigned int n_particles = shape.n_particles();
    const PointStiffness stiffness(part_points, time_step);
    const double *const volume = part_points.points().component(MaterialPoints::volume, 0);
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
  void NodalParticles<dim>::add_conduction(const NodalVector &position,
                                           const NodalVector &of_conductivity,
                                           const NodalVector &temperature,
                                           NodalVector &heat_rate) const
  {
    const Stencils &shape = this->stencils();
    const TemperatureTable &conductivity = part_points.heat()->conductivity();
    if (conductivity.largest() == 0.)
      return;
    const double *const volume = part_points.has_mechanics()
                                     ? part_points.points().component(MaterialPoints::volume, 0)
                                     : set.initial_volumes().data();
    for (unsigned int row = 0; row < shape.n_particles(); ++row)
    {
      if (shape.is_rigid(row))
        continue; // without ∇φ it conducts nothing
      const double conducted =
          volume[row] * (conductivity.is_constant()
                             ? conductivity.largest()
                             : conductivity.value(*of_conductivity.node(shape.particle_node[row])));
      RowBlock::conduct<dim>(
          shape, row, shape.is_undeformed(row), position, temperature,
          [conducted](const double /*det*/) { return conducted; }, heat_rate);
    }
  }

  template <int dim>
  void NodalParticles<dim>::add_plastic_heat(NodalVector &heat)
  {
    if (!part_points.heating().has_plastic_heat())
      return;
    const std::vector<unsigned int> &nodes = this->particle_nodes();
    for (unsigned int i = 0; i < nodes.size(); ++i)
      *heat.node(nodes[i]) += part_points.heating().give(this->points(), i);
  }

  template <int dim>
  void NodalParticles<dim>::courant_limits(const NodalVector &position,
                                           std::vector<double> &time_steps) const
  {
    time_steps.clear();
    const PointStiffness stiffness(part_points);
    const double speed = this->material().longitudinal_wave_speed();
    kernel.for_present_supports(set, this->stencils(), position,
                                [&](const unsigned int i, const double *half_width)
                                {
                                  time_steps.push_back(
                                      *std::min_element(half_width, half_width + dim) /
                                      (speed * stiffness.relative_speed(i)));
                                });
  }

  template <int dim>
  StepLimit NodalParticles<dim>::diffusion_limit(const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "particle";
    const double diffusivity =
        part_points.heat()->largest_diffusivity() / this->material().density();
    if (diffusivity == 0.)
      return limit;
    kernel.for_present_supports(
        set, this->stencils(), position,
        [&](const unsigned int i, const double *half_width)
        {
          const double *const place = position.node(this->particle_nodes()[i]);
          for (unsigned int d = 0; d < dim; ++d)
            if (const double step = half_width[d] * half_width[d] / (2. * diffusivity);
                step < limit.time_step)
            {
              limit.time_step = step;
              std::copy_n(place, dim, &limit.place[0]);
            }
        });
    return limit;
  }

  template <int dim>
  void
  NodalParticles<dim>::find_cell_equations(const MechanicalInput &input,
                                           const std::function<void(const CellEquations &)> &take)
  {
    const Stencils &shape = this->stencils();
    using Stiffness = RowStiffness<dim, 1>;
    const auto stiffness = std::make_unique<Stiffness>(part_points, false, input.time_increment);
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
        gradients.volume[0][lane] = set.initial_volumes()[first + lane];
        if (part_points.heating().is_on())
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
  void NodalParticles<dim>::find_couplings(const NodeGroupAction &use) const
  {
    for (unsigned int i = 0; i < this->stencils().n_particles(); ++i)
    {
      const Stencils::Row row = this->stencils().row(i);
      use(std::vector<unsigned int>(row.neighbour, row.neighbour + row.size));
    }
  }

  template <int dim>
  std::optional<std::string> NodalParticles<dim>::unfit_to_linearize() const
  {
    if (kernel.follows_motion())
      return "supports that stay as they are and kernels in the current configuration, whose "
             "deformation has no state to go back to";
    return part_points.unfit_to_linearize();
  }

  template class NodalParticles<2>;
  template class NodalParticles<3>;
} // namespace tombolo
