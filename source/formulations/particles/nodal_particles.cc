// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/nodal_particles.h>

#include <tombolo/formulations/particles/cell_dilatation.h>
#include <tombolo/formulations/particles/particle_block.h>
#include <tombolo/formulations/particles/zero_energy_control.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>
#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <memory>

namespace tombolo
{
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
    using namespace ParticleBlock;
    Stencils &shape = this->stencils();
    shape.inverse_deformation.resize_fast(3 * node_stride * shape.particle_node.size());
    const std::vector<double> &initial_volume = set.initial_volumes();
    const unsigned int n_particles = shape.n_particles();
    BlockMatrices h, f;
    PointSweep<block_size> sweep(part_points, input.time_increment);
    double *const volume = part_points.points().component(MaterialPoints::volume, 0);
    const double *const ratio = part_points.points().component(MaterialPoints::volume_ratio, 0);
    alignas(64) double spin[3][block_size];
    alignas(64) BlockVectors residual;
    const double *const spins[3] = {spin[0], spin[1], spin[2]};
    if (dilatation != nullptr)
      dilatation->find(*input.position);
    for (unsigned int first = 0; first < n_particles; first += block_size)
    {
      const unsigned int last = std::min(first + block_size, n_particles);
      const unsigned int n = padded_to_lanes(last - first);
      const double *const inverse_f =
          find_motion<dim>(shape, first, last, input.position->data(), input.velocity->data(), h, f,
                           control != nullptr ? &residual : nullptr);
      if (!shape.inverse_deformation_is_current)
        std::copy_n(inverse_f, 3 * node_stride * std::size_t(last - first),
                    &shape.inverse_deformation[3 * node_stride * std::size_t(first)]);
      follow_motion(h, inverse_f, first, last, input.time_increment,
                    kernel.deformation_of_motion());
      sweep.begin(first, n);
      for (unsigned int p = 0; p < n; p += n_lanes)
      {
        MotionIncrement<Lanes> motion =
            sweep.motion(p, increment_at(h, inverse_f, p, input.time_increment));
        if (dilatation != nullptr)
          dilatation->share(first + p, load_lanes(ratio + first + p), part_points.is_logarithmic(),
                            motion);
        sweep.move(p, motion);
        for (unsigned int d = 0; d < 3 && control != nullptr; ++d)
          store_lanes(motion.spin[d], spin[d] + p);
      }
      if (control != nullptr)
        control->begin(part_points.points(), first, last);
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
        if (dilatation != nullptr)
          dilatation->collect(
              first + p, 1. / determinant(load_columns(inverse_f + 3 * node_stride * p)), stress);
        store_columns(
            multiply(symmetric_matrix(stress), load_columns(inverse_f + 3 * node_stride * p)),
            h.columns[p][0]);
      }
      if (control != nullptr)
        control->advance(part_points.points(), first, last, spins, residual[0]);
      scatter_force(shape, first, last, h, control != nullptr ? &residual : nullptr, force.data());
    }
    shape.inverse_deformation_is_current = true;
    if (dilatation != nullptr)
      dilatation->add_force(force);
  }

  template <int dim>
  void NodalParticles<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                    const NodalVector &velocity,
                                                    const double time_step,
                                                    NodalVector &force) const
  {
    using namespace ParticleBlock;
    const Stencils &shape = this->stencils();
    const unsigned int n_particles = shape.n_particles();
    const PointStiffness stiffness(part_points, time_step);
    const double *const volume = part_points.points().component(MaterialPoints::volume, 0);
    BlockMatrices h, f;
    if (dilatation != nullptr)
    {
      dilatation->find(position);
      dilatation->find_rates(velocity);
    }
    for (unsigned int first = 0; first < n_particles; first += block_size)
    {
      const unsigned int last = std::min(first + block_size, n_particles);
      const double *const inverse_f =
          find_motion<dim>(shape, first, last, position.data(), velocity.data(), h, f, nullptr);
      for (unsigned int p = 0; p < last - first; p += n_lanes)
      {
        const Matrix3<Lanes> inverse_transpose = load_columns(inverse_f + 3 * node_stride * p);
        Lanes stress[6];
        Matrix3<Lanes> gradient =
            multiply(load_columns(h.columns[p][0]), transposed(inverse_transpose));
        Lanes rate_of_own = 0.;
        if (dilatation != nullptr)
          rate_of_own = dilatation->share_rate(first + p, gradient);
        // scatter_force() subtracts.
        stiffness.find_stress(first + p, gradient, -load_lanes(volume + first + p), stress);
        if (dilatation != nullptr)
          dilatation->collect_rates(first + p, 1. / determinant(inverse_transpose), rate_of_own,
                                    stress);
        store_columns(multiply(symmetric_matrix(stress), inverse_transpose), h.columns[p][0]);
      }
      scatter_force(shape, first, last, h, nullptr, force.data());
    }
    if (control != nullptr)
      control->apply_stiffness(shape, velocity, force);
    if (dilatation != nullptr)
      dilatation->add_force_of_rates(force);
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
    Lanes ratio = 1.;
    if (dilatation != nullptr)
    {
      dilatation->find(*input.position);
      gradients.volume_ratio = &ratio;
      gradients.own_modulus = dilatation->modulus_of_own();
    }
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
      if (dilatation != nullptr)
        ratio = dilatation->ratio(first);
      if (control != nullptr)
        control->begin(this->points(), first, first + n);
      stiffness->find(first, gradients, temperature);
      for (unsigned int lane = 0; lane < n; ++lane)
        stiffness->hand_over(lane, {{shape.row(first + lane)}},
                             [&](CellEquations &equations)
                             {
                               if (dilatation != nullptr)
                                 dilatation->add_tangent(first + lane, stiffness->ratio_terms(),
                                                         equations);
                               if (control != nullptr)
                                 control->add_tangent(shape, this->points(), first, first + lane,
                                                      *input.position, equations);
                               take(equations);
                             });
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
