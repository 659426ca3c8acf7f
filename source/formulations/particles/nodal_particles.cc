// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/nodal_particles.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/row_material.h>
#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  /** Formulation::find_cell_equations() of particles that are integrated at their nodes: a particle
   * and its row stand for a cell. */
  template <int dim>
  void find_particle_equations(const Stencils &shape, const std::vector<double> &initial_volume,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take);

  template <int dim>
  void find_particle_equations(const Stencils &shape, const std::vector<double> &initial_volume,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take)
  {
    using Stiffness = RowStiffness<dim, 1>;
    const auto stiffness = std::make_unique<Stiffness>(material, input.time_increment);
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
        if (material.plastic_heating->is_on())
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

  template void find_particle_equations<2>(const Stencils &, const std::vector<double> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);
  template void find_particle_equations<3>(const Stencils &, const std::vector<double> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);

  template <int dim>
  NodalParticles<dim>::NodalParticles(const BulkViscosity &viscosity, const StrainMeasure measure)
      : integration(viscosity, measure)
  {}

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
  const ParticleSet<dim> &NodalParticles<dim>::particle_set() const
  {
    return set;
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
  Tensor<2, dim> NodalParticles<dim>::deformation(const unsigned int i,
                                                  const NodalVector &position) const
  {
    return kernel.total_deformation(i, this->stencils(), position);
  }

  template <int dim>
  void NodalParticles<dim>::add_internal_force(const MechanicalInput &input, NodalVector &force)
  {
    integration.add_internal_force(set, this->stencils(), input, kernel.deformation_of_motion(),
                                   force);
  }

  template <int dim>
  void NodalParticles<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                    const NodalVector &velocity,
                                                    const double time_step,
                                                    NodalVector &force) const
  {
    integration.apply_elastic_stiffness(this->stencils(), position, velocity, time_step, force);
  }

  template <int dim>
  void NodalParticles<dim>::courant_limits(const NodalVector &position,
                                           std::vector<double> &time_steps) const
  {
    time_steps = integration.courant_limits(set, kernel, this->stencils(), position);
  }

  template <int dim>
  EnergyAccounts NodalParticles<dim>::energies() const
  {
    return integration.energies();
  }

  template <int dim>
  void NodalParticles<dim>::add_conduction(const NodalVector &position,
                                           const NodalVector &of_conductivity,
                                           const NodalVector &temperature,
                                           NodalVector &heat_rate) const
  {
    integration.add_conduction(set, this->stencils(), position, of_conductivity, temperature,
                               heat_rate);
  }

  template <int dim>
  StepLimit NodalParticles<dim>::diffusion_limit(const NodalVector &position) const
  {
    return integration.diffusion_limit(set, kernel, this->stencils(), position);
  }

  template <int dim>
  void NodalParticles<dim>::add_plastic_heat(NodalVector &heat)
  {
    integration.add_plastic_heat(this->stencils(), heat);
  }

  template <int dim>
  double NodalParticles<dim>::pending_plastic_heat() const
  {
    return integration.pending_plastic_heat();
  }

  template <int dim>
  void
  NodalParticles<dim>::find_cell_equations(const MechanicalInput &input,
                                           const std::function<void(const CellEquations &)> &take)
  {
    find_particle_equations<dim>(this->stencils(), set.initial_volumes(),
                                 integration.row_material(), input, take);
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
    return integration.unfit_to_linearize();
  }

  template <int dim>
  const MaterialPoints &NodalParticles<dim>::points() const
  {
    return integration.points();
  }

  template <int dim>
  MaterialPoints &NodalParticles<dim>::points()
  {
    return integration.points();
  }

  template <int dim>
  const Material &NodalParticles<dim>::material() const
  {
    return integration.material();
  }

  template class NodalParticles<2>;
  template class NodalParticles<3>;
} // namespace tombolo
