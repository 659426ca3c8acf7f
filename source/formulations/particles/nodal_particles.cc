// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/nodal_particles.h>

#include <tombolo/formulations/particles/particle_force.h>
#include <tombolo/formulations/point_stiffness.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

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
    ParticleForce::add_internal_force(part_points, this->stencils(), set.initial_volumes(), input,
                                      kernel.deformation_of_motion(), force);
  }

  template <int dim>
  void NodalParticles<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                    const NodalVector &velocity,
                                                    const double time_step,
                                                    NodalVector &force) const
  {
    ParticleForce::apply_elastic_stiffness<dim>(part_points, this->stencils(), position, velocity,
                                                time_step, force);
  }

  template <int dim>
  void NodalParticles<dim>::add_conduction(const NodalVector &position,
                                           const NodalVector &of_conductivity,
                                           const NodalVector &temperature,
                                           NodalVector &heat_rate) const
  {
    ParticleForce::add_conduction<dim>(part_points, this->stencils(), set.initial_volumes(),
                                       position, of_conductivity, temperature, heat_rate);
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
    ParticleForce::find_cell_equations<dim>(part_points, this->stencils(), set.initial_volumes(),
                                            input, take);
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
