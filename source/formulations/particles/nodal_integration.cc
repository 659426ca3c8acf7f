// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/nodal_integration.h>

#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/particles/particle_force.h>
#include <tombolo/formulations/point_stiffness.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  NodalIntegration<dim>::NodalIntegration(const BulkViscosity &viscosity,
                                          const StrainMeasure measure)
      : bulk_viscosity(viscosity), strain_measure(measure)
  {}

  template <int dim>
  void NodalIntegration<dim>::initialize(const PartSetup<dim> &setup)
  {
    part_material = setup.material;
    thermal_properties = setup.heat;
    has_points = setup.has_mechanics;
    if (has_points)
      plastic_heating.set(setup.heat, *part_material);
  }

  template <int dim>
  void NodalIntegration<dim>::create_points(const ParticleSet<dim> &particles,
                                            const std::vector<FieldDescription> &further)
  {
    if (!has_points)
    {
      material_points.reinit(0, {});
      return;
    }
    std::vector<FieldDescription> variables = part_material->internal_variables();
    for (const std::vector<FieldDescription> &fields :
         {bulk_viscosity.variables(), plastic_heating.variables(), further})
      variables.insert(variables.end(), fields.begin(), fields.end());
    material_points.reinit(particles.size(), variables);
    std::copy(particles.initial_volumes().begin(), particles.initial_volumes().end(),
              material_points.component(MaterialPoints::volume, 0));
    bulk_viscosity.initialize(*part_material, dim, material_points);
    plastic_heating.initialize(material_points);
  }

  template <int dim>
  std::vector<double>
  NodalIntegration<dim>::present_volumes(const ParticleSet<dim> &particles) const
  {
    std::vector<double> volumes = particles.initial_volumes();
    if (material_points.size() > 0)
      std::copy_n(material_points.component(MaterialPoints::volume, 0), volumes.size(),
                  volumes.begin());
    return volumes;
  }

  template <int dim>
  void NodalIntegration<dim>::add_internal_force(const ParticleSet<dim> &particles, Stencils &shape,
                                                 const MechanicalInput &input,
                                                 std::vector<Tensor<2, dim>> *const deformation,
                                                 NodalVector &force)
  {
    ParticleForce::add_internal_force<dim>(
        shape, particles.initial_volumes(), *part_material, strain_measure, input.position->data(),
        input.velocity->data(), input.temperature == nullptr ? nullptr : input.temperature->data(),
        input.time_increment, bulk_viscosity, plastic_heating, material_points, deformation,
        force.data());
  }

  template <int dim>
  void
  NodalIntegration<dim>::apply_elastic_stiffness(const Stencils &shape, const NodalVector &position,
                                                 const NodalVector &velocity,
                                                 const double time_step, NodalVector &force) const
  {
    ParticleForce::apply_elastic_stiffness<dim>(shape, *part_material, strain_measure,
                                                material_points, position.data(), velocity.data(),
                                                time_step, bulk_viscosity, force.data());
  }

  template <int dim>
  RowMaterial NodalIntegration<dim>::row_material()
  {
    RowMaterial result{
        part_material.get(), strain_measure, &plastic_heating, &material_points, {}, false};
    const std::size_t n_fields =
        MaterialPoints::n_standard_fields + part_material->internal_variables().size();
    for (unsigned int field = MaterialPoints::n_standard_fields; field < n_fields; ++field)
      for (unsigned int c = 0; c < material_points.fields()[field].n_components; ++c)
        result.variables.push_back(material_points.component(field, c));
    return result;
  }

  template <int dim>
  std::string NodalIntegration<dim>::unfit_to_linearize() const
  {
    if (bulk_viscosity.is_on())
      return "artificial bulk viscosity, which resists rates";
    return "";
  }

  template <int dim>
  void NodalIntegration<dim>::add_conduction(const ParticleSet<dim> &particles,
                                             const Stencils &shape, const NodalVector &position,
                                             const NodalVector &of_conductivity,
                                             const NodalVector &temperature,
                                             NodalVector &heat_rate) const
  {
    ParticleForce::add_conduction<dim>(
        shape, particles.initial_volumes(), thermal_properties->conductivity(),
        has_points ? &material_points : nullptr, position.data(), of_conductivity.data(),
        temperature.data(), heat_rate.data());
  }

  template <int dim>
  void NodalIntegration<dim>::add_plastic_heat(const Stencils &shape, NodalVector &heat)
  {
    if (!plastic_heating.has_plastic_heat())
      return;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      *heat.node(shape.particle_node[i]) += plastic_heating.give(material_points, i);
  }

  template <int dim>
  double NodalIntegration<dim>::pending_plastic_heat() const
  {
    return plastic_heating.pending(material_points);
  }

  template <int dim>
  std::vector<double> NodalIntegration<dim>::elastic_energies() const
  {
    std::vector<double> result(material_points.padded_size());
    const double *stress[6];
    for (unsigned int c = 0; c < 6; ++c)
      stress[c] = material_points.component(MaterialPoints::stress, c);
    part_material->elastic_energy_density(material_points.padded_size(), stress, temperature(),
                                          result.data());
    const double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    for (unsigned int i = 0; i < material_points.padded_size(); ++i)
      result[i] *= volume[i];
    if (strain_measure == StrainMeasure::logarithmic) // ½ τ : ε of an initial volume
      for (unsigned int i = 0; i < material_points.padded_size(); ++i)
        result[i] *= ratio[i];
    if (const unsigned int field = material_points.find_field("pressure work");
        field < material_points.fields().size())
    {
      const double *const work = material_points.component(field, 0);
      for (unsigned int i = 0; i < material_points.padded_size(); ++i)
        result[i] += work[i] * volume[i] / ratio[i];
    }
    return result;
  }

  template <int dim>
  EnergyAccounts NodalIntegration<dim>::energies() const
  {
    const std::vector<double> of_points = elastic_energies();
    double elastic = 0.;
    for (unsigned int i = 0; i < material_points.size(); ++i)
      elastic += of_points[i];
    EnergyAccounts result;
    result.add("elastic energy", EnergyKind::stored, elastic);
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored, 0.);
    result.add("viscous dissipation", EnergyKind::artificial,
               integral_over_initial_volume(material_points, BulkViscosity::dissipation_name));
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(material_points, "thermal work"));
    return result;
  }

  template <int dim>
  std::vector<double> NodalIntegration<dim>::courant_limits(const ParticleSet<dim> &particles,
                                                            const KernelConfiguration<dim> &kernel,
                                                            const Stencils &shape,
                                                            const NodalVector &position) const
  {
    std::vector<double> time_steps;
    const PointStiffness stiffness(*part_material, material_points, strain_measure);
    const double speed = part_material->longitudinal_wave_speed();
    kernel.for_present_supports(particles, shape, position,
                                [&](const unsigned int i, const double *half_width)
                                {
                                  time_steps.push_back(
                                      *std::min_element(half_width, half_width + dim) /
                                      (speed * stiffness.relative_speed(i)));
                                });
    return time_steps;
  }

  template <int dim>
  StepLimit NodalIntegration<dim>::diffusion_limit(const ParticleSet<dim> &particles,
                                                   const KernelConfiguration<dim> &kernel,
                                                   const Stencils &shape,
                                                   const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "particle";
    const double diffusivity = thermal_properties->largest_diffusivity() / part_material->density();
    if (diffusivity == 0.)
      return limit;
    kernel.for_present_supports(particles, shape, position,
                                [&](const unsigned int i, const double *half_width)
                                {
                                  for (unsigned int d = 0; d < dim; ++d)
                                  {
                                    const double step =
                                        half_width[d] * half_width[d] / (2. * diffusivity);
                                    if (step >= limit.time_step)
                                      continue;
                                    limit.time_step = step;
                                    for (unsigned int c = 0; c < dim; ++c)
                                      limit.place[c] = position.node(shape.particle_node[i])[c];
                                  }
                                });
    return limit;
  }

  template <int dim>
  void NodalIntegration<dim>::merge_points(const ParticleSet<dim> &particles,
                                           const MaterialPoints &old_points,
                                           const std::vector<double> &old_volume,
                                           const std::vector<unsigned int> &old_index,
                                           const StateTransfer &state)
  {
    const unsigned int n = particles.size();
    const std::vector<double> &initial_volume = particles.initial_volumes();
    const auto is_old = [&](const std::size_t i) { return old_index[i] < old_volume.size(); };
    // Local numbers of owned nodes are their indices among them.
    const auto node_of = [&](const std::size_t i)
    {
      return static_cast<unsigned int>(
          particles.owned_nodes().index_within_set(particles.nodes()[i]));
    };
    std::vector<double> old_share(n, 0.);
    for (unsigned int i = 0; i < n; ++i)
      if (is_old(i))
        old_share[i] = *state.volume.node(node_of(i)) == 0.
                           ? 1.
                           : old_volume[old_index[i]] / initial_volume[i];

    const std::vector<FieldDescription> &fields = material_points.fields();
    for (unsigned int f = 0; f < fields.size(); ++f)
    {
      const bool is_energy_per_volume = fields[f].name == BulkViscosity::dissipation_name ||
                                        fields[f].name == Bonds<dim>::dissipation_name;
      for (unsigned int c = 0; c < fields[f].n_components; ++c)
        for (unsigned int i = 0; i < n; ++i)
          if (is_old(i))
            material_points.component(f, c)[i] = old_points.component(f, c)[old_index[i]] *
                                                 (is_energy_per_volume ? old_share[i] : 1.);
    }
    for (const StateTransfer::Component &component : state.components)
    {
      double *const values = material_points.component(component.target_field, component.number);
      // The temperature of points is settled below.
      if (plastic_heating.is_on() &&
          fields[component.target_field].name == PlasticHeating::temperature_name)
        continue;
      for (unsigned int i = 0; i < n; ++i)
        if (const double volume = *state.volume.node(node_of(i)); volume > 0.)
          values[i] = old_share[i] * values[i] +
                      (1. - old_share[i]) * *component.sum.node(node_of(i)) / volume;
    }
    double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    for (unsigned int i = 0; i < n; ++i)
    {
      volume[i] = initial_volume[i] * ratio[i];
      if (!plastic_heating.is_on() || *state.volume.node(node_of(i)) == 0.)
        continue;
      double pending = *state.pending_heat.node(node_of(i));
      if (is_old(i) && plastic_heating.has_plastic_heat())
        pending += plastic_heating.pending(old_points, old_index[i]);
      plastic_heating.settle(material_points, i, old_share[i], pending,
                             *state.temperature->node(node_of(i)));
    }
  }

  template <int dim>
  const MaterialPoints &NodalIntegration<dim>::points() const
  {
    return material_points;
  }

  template <int dim>
  MaterialPoints &NodalIntegration<dim>::points()
  {
    return material_points;
  }

  template <int dim>
  const Material &NodalIntegration<dim>::material() const
  {
    return *part_material;
  }

  template <int dim>
  StrainMeasure NodalIntegration<dim>::measure() const
  {
    return strain_measure;
  }

  template <int dim>
  const double *NodalIntegration<dim>::temperature() const
  {
    return plastic_heating.temperature(material_points);
  }

  template class NodalIntegration<2>;
  template class NodalIntegration<3>;
} // namespace tombolo
