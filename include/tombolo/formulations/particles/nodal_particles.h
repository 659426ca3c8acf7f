// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/cell_dilatation.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_block.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/zero_energy_control.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/formulations/point_sweep.h>
#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Particles of one part that are integrated at their nodes, whatever their φ and ∇φ are: a
   * particle method that derives from this class fills its stencils, names the nodes that they need
   * and translates their numbers. Everything else follows from the stencils.
   */
  template <int dim>
  class NodalParticles : public ParticleFormulation<dim>
  {
  public:
    /** Where elements of half the size lie beside cells of particles, or these beside elements of
     * twice their size. Such nodes are no particles. */
    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }
    const ParticleSet<dim> &particle_set() const override
    {
      return set;
    }
    bool follows_positions() const override
    {
      return dilatation != nullptr;
    }
    dealii::Point<dim> support(const unsigned int i) const override
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = kernel.supports()[std::size_t(i) * node_stride + d];
      return result;
    }
    dealii::Tensor<2, dim> deformation(const unsigned int i,
                                       const NodalVector &position) const override
    {
      return kernel.total_deformation(i, this->stencils(), position);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override
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
      alignas(64) double spin[3][block_size], couple[3][block_size];
      alignas(64) BlockVectors residual;
      const double *const spins[3] = {spin[0], spin[1], spin[2]};
      double *const couples[3] = {couple[0], couple[1], couple[2]};
      if (dilatation != nullptr)
        dilatation->find(*input.position);
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const unsigned int n = padded_to_lanes(last - first);
        const double *const inverse_f =
            find_motion<dim>(shape, first, last, input.position->data(), input.velocity->data(), h,
                             f, control != nullptr ? &residual : nullptr);
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
            dilatation->share(first + p, load_lanes(ratio + first + p),
                              part_points.is_logarithmic(), motion);
          sweep.move(p, motion);
          for (unsigned int d = 0; d < 3 && control != nullptr; ++d)
            store_lanes(motion.spin[d], spin[d] + p);
        }
        if (control != nullptr)
          control->begin(part_points.points(), first, last);
        if (part_points.heating().is_on())
          for (unsigned int row = first; row < last; ++row)
            sweep.nodal_temperature[row - first] =
                *input.temperature->node(shape.particle_node[row]);
        sweep.update_stress();
        for (unsigned int p = first; p < last; ++p)
          volume[p] = initial_volume[p] * ratio[p];
        sweep.update_viscosity();
        const bool has_couples =
            control != nullptr &&
            control->advance(part_points.points(), first, last, spins, residual[0], couples);
        // K = V σ F⁻ᵀ turns gradients of the reference into forces.
        for (unsigned int p = 0; p < n; p += n_lanes)
        {
          Lanes stress[6];
          part_points.integrate_stress(first + p, stress);
          if (dilatation != nullptr)
            dilatation->collect(
                first + p, 1. / determinant(load_columns(inverse_f + 3 * node_stride * p)), stress);
          Matrix3<Lanes> stress_matrix = symmetric_matrix(stress);
          if (has_couples)
            ZeroEnergyControl::add_couples(couples, p, stress_matrix);
          store_columns(multiply(stress_matrix, load_columns(inverse_f + 3 * node_stride * p)),
                        h.columns[p][0]);
        }
        scatter_force(shape, first, last, h, control != nullptr ? &residual : nullptr,
                      force.data());
      }
      shape.inverse_deformation_is_current = true;
      if (dilatation != nullptr)
        dilatation->add_force(force);
    }
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force) const override
    {
      using namespace ParticleBlock;
      const Stencils &shape = this->stencils();
      const unsigned int n_particles = shape.n_particles();
      const PointStiffness stiffness(part_points, time_step);
      const double *const volume = part_points.points().component(MaterialPoints::volume, 0);
      BlockMatrices h, f;
      alignas(64) BlockVectors residual;
      // Positions are not needed where F⁻¹ is current: residuals are those of velocities.
      const bool has_residual = control != nullptr && shape.inverse_deformation_is_current;
      if (dilatation != nullptr)
      {
        if (!position_is_held)
          dilatation->find(position);
        dilatation->find_rates(velocity);
      }
      for (unsigned int first = 0; first < n_particles; first += block_size)
      {
        const unsigned int last = std::min(first + block_size, n_particles);
        const double *const inverse_f =
            find_motion<dim>(shape, first, last, (has_residual ? velocity : position).data(),
                             velocity.data(), h, f, has_residual ? &residual : nullptr);
        for (unsigned int p = 0; p < last - first; p += n_lanes)
        {
          const Matrix3<Lanes> inverse_transpose = load_columns(inverse_f + 3 * node_stride * p);
          Lanes stress[6];
          Matrix3<Lanes> gradient =
              multiply(load_columns(h.columns[p][0]), transposed(inverse_transpose));
          Lanes mean_rate = 0., rate_of_own = 0.;
          if (dilatation != nullptr)
            rate_of_own = dilatation->share_rate(first + p, gradient, mean_rate);
          // scatter_force() subtracts.
          stiffness.find_stress(first + p, gradient, -load_lanes(volume + first + p), stress);
          if (dilatation != nullptr)
            dilatation->collect_rates(first + p, 1. / determinant(inverse_transpose), mean_rate,
                                      rate_of_own, stress);
          store_columns(multiply(symmetric_matrix(stress), inverse_transpose), h.columns[p][0]);
        }
        if (has_residual)
          control->multiply_by_stiffness(first, last, residual[0]);
        scatter_force(shape, first, last, h, has_residual ? &residual : nullptr, force.data());
      }
      if (control != nullptr && !has_residual)
        control->apply_stiffness(shape, velocity, force);
      if (dilatation != nullptr)
        dilatation->add_force_of_rates(force);
    }
    void hold_position(const NodalVector *const position) override
    {
      bool &is_current = this->stencils().inverse_deformation_is_current;
      position_is_held = position != nullptr;
      if (!position_is_held)
      {
        is_current = was_current; // the next forces find deformations of their own
        return;
      }
      was_current = is_current;
      NodalSmoothing::try_inverse_deformation<dim>(position->data(), this->stencils());
      if (dilatation != nullptr)
        dilatation->find(*position);
    }
    void courant_limits(const NodalVector &position, std::vector<double> &time_steps) const override
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
    void add_conduction(const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
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
            volume[row] *
            (conductivity.is_constant()
                 ? conductivity.largest()
                 : conductivity.value(*conductivity_temperature.node(shape.particle_node[row])));
        RowBlock::conduct<dim>(
            shape, row, shape.is_undeformed(row), position, temperature,
            [conducted](const double /*det*/) { return conducted; }, heat_rate);
      }
    }
    StepLimit diffusion_limit(const NodalVector &position) const override
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
            const double *const x = position.node(this->particle_nodes()[i]);
            for (unsigned int d = 0; d < dim; ++d)
              if (const double step = half_width[d] * half_width[d] / (2. * diffusivity);
                  step < limit.time_step)
              {
                limit.time_step = step;
                std::copy_n(x, dim, &limit.position[0]);
              }
          });
      return limit;
    }
    void add_plastic_heat(NodalVector &heat) override
    {
      if (!part_points.heating().has_plastic_heat())
        return;
      const std::vector<unsigned int> &nodes = this->particle_nodes();
      for (unsigned int i = 0; i < nodes.size(); ++i)
        *heat.node(nodes[i]) += part_points.heating().give(this->points(), i);
    }
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override
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
    void find_couplings(const NodeGroupAction &use) const override
    {
      for (unsigned int i = 0; i < this->stencils().n_particles(); ++i)
      {
        const Stencils::Row row = this->stencils().row(i);
        use(std::vector<unsigned int>(row.neighbour, row.neighbour + row.size));
      }
    }
    std::optional<std::string> unfit_to_linearize() const override
    {
      if (kernel.follows_motion())
        return "supports that stay as they are and kernels in the current configuration, whose "
               "deformation has no state to go back to";
      return part_points.unfit_to_linearize();
    }

  protected:
    /** Finds the particles of the cells of @p is_taken, in their initial configuration. Returns
     * their masses. @p volumes: initial ones at owned nodes [L^dim]; null: those of the mesh. */
    std::vector<double> collect_particles(const PartSetup<dim> &setup, const double dilation,
                                          const CellSelection<dim> &is_taken,
                                          const NodalVector *const volumes = nullptr)
    {
      std::vector<double> masses =
          set.collect(setup, dilation, is_taken, ParticleSet<dim>::DependentNodes::give_way);
      if (volumes != nullptr)
      {
        std::vector<double> particle_volumes;
        for (const dealii::types::global_dof_index node : set.nodes())
          particle_volumes.push_back(
              *volumes->node(static_cast<unsigned int>(set.owned_nodes().index_within_set(node))));
        set.set_initial_volumes(particle_volumes);
        for (std::size_t i = 0; i < masses.size(); ++i)
          masses[i] = setup.material->density() * particle_volumes[i];
      }
      kernel.reset(set);
      return masses;
    }

    /** Makes the points of the particles as they are at the start, with @p further fields behind
     * those of material, viscosity and heat; none in a scene of heat alone. */
    void create_points(const std::vector<FieldDescription> &further = {})
    {
      if (!part_points.has_mechanics())
        return;
      part_points.create(set.size(), {}, further);
      std::copy(set.initial_volumes().begin(), set.initial_volumes().end(),
                this->points().component(MaterialPoints::volume, 0));
      part_points.begin_with_volumes(dim);
    }

    using Formulation<dim>::part_points;
    ParticleSet<dim> set;
    KernelConfiguration<dim> kernel;
    CellDilatation<dim> *dilatation = nullptr; ///< null: particles have their own
    ZeroEnergyControl *control = nullptr;      ///< of modes that hardly change gradients; or null

  private:
    bool position_is_held = false, was_current = false; ///< was: F⁻¹, before it was held
  };
} // namespace tombolo
