// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/row_deformation.h>
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MomentumConsistentParticle<dim>::add_particles(const CellSelection<dim> &is_taken,
                                                      const NodalVector &position,
                                                      const StateTransfer *const state)
  {
    has_started = true;
    const bool renews = configuration != Configuration::total_lagrangian && state != nullptr;
    const bool has_broken = bonds && bonds->any();
    if (has_broken)
      bonds->prepare_search(partition_of_rows(), neighbourhoods, shape);
    if (renews)
      follow_deformation(position);
    const std::vector<types::global_dof_index> old_particles = particle_global;
    const std::vector<double> old_volume = initial_volume;
    const std::vector<Tensor<2, dim>> old_deformation = reference_deformation;
    const MaterialPoints old_points = material_points;

    collect_particles(is_taken);
    std::vector<unsigned int> old_place;
    for (std::size_t i = 0; i < particle_global.size(); ++i)
    {
      const auto found =
          std::lower_bound(old_particles.begin(), old_particles.end(), particle_global[i]);
      const bool is_old = found != old_particles.end() && *found == particle_global[i];
      old_place.push_back(is_old ? static_cast<unsigned int>(found - old_particles.begin())
                                 : is_new_particle);
      if (is_old)
        reference_deformation[i] = old_deformation[old_place[i]];
    }
    create_points();
    if (state != nullptr)
      merge_points(old_points, old_volume, old_place, *state);
    if (bonds)
    {
      std::vector<bool> gains;
      for (const types::global_dof_index node : particle_global)
        gains.push_back(state != nullptr && *state->volume.node(static_cast<unsigned int>(
                                                owned_nodes.index_within_set(node))) > 0.);
      bonds->add_particles(persistent_ids(), old_place, gains);
    }
    if (renews)
      renew_reference(position, old_place);
    const std::vector<double> initial = renews ? std::vector<double>() : spread_initial_positions();
    neighbourhoods.search(particle_global, renews ? present_position : initial, present_support,
                          communicator, shape);
    if (bonds)
      bonds->finish_search(has_broken ? partition_of_rows() : nullptr, neighbourhoods, shape);
    compute_shape_functions(neighbourhoods.position_at_search().data(),
                            neighbourhoods.support_at_search().data());
    if (bonds && !renews)
      bonds->measure_rows(shape);
    release_debris();
    tell_self_contact();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::merge_points(const MaterialPoints &old_points,
                                                     const std::vector<double> &old_volume,
                                                     const std::vector<unsigned int> &old_place,
                                                     const StateTransfer &state)
  {
    // Local numbers of owned nodes are their places among them.
    const auto node_of = [&](const std::size_t i)
    { return static_cast<unsigned int>(owned_nodes.index_within_set(particle_global[i])); };
    std::vector<double> old_share(particle_global.size(), 0.);
    for (std::size_t i = 0; i < particle_global.size(); ++i)
      if (old_place[i] != is_new_particle)
        old_share[i] = *state.volume.node(node_of(i)) == 0.
                           ? 1.
                           : old_volume[old_place[i]] / initial_volume[i];

    const std::vector<FieldDescription> &fields = material_points.fields();
    for (unsigned int f = 0; f < fields.size(); ++f)
    {
      const bool is_energy_per_volume = fields[f].name == BulkViscosity::dissipation_name ||
                                        fields[f].name == Bonds<dim>::dissipation_name;
      for (unsigned int c = 0; c < fields[f].n_components; ++c)
        for (std::size_t i = 0; i < particle_global.size(); ++i)
          if (old_place[i] != is_new_particle)
            material_points.component(f, c)[i] = old_points.component(f, c)[old_place[i]] *
                                                 (is_energy_per_volume ? old_share[i] : 1.);
    }
    for (const StateTransfer::Component &component : state.components)
    {
      double *const values = material_points.component(component.target_field, component.number);
      for (std::size_t i = 0; i < particle_global.size(); ++i)
      {
        const double volume = *state.volume.node(node_of(i));
        // Of heat, points get theirs below.
        if (volume > 0. && !(plastic_heating.is_on() && fields[component.target_field].name ==
                                                            PlasticHeating::temperature_name))
          values[i] = old_share[i] * values[i] +
                      (1. - old_share[i]) * *component.sum.node(node_of(i)) / volume;
      }
    }
    double *const volume = material_points.component(MaterialPoints::volume, 0);
    const double *const ratio = material_points.component(MaterialPoints::volume_ratio, 0);
    for (unsigned int i = 0; i < particle_global.size(); ++i)
    {
      volume[i] = initial_volume[i] * ratio[i];
      if (!plastic_heating.is_on() || *state.volume.node(node_of(i)) == 0.)
        continue;
      double pending = *state.pending_heat.node(node_of(i));
      if (old_place[i] != is_new_particle && plastic_heating.has_plastic_heat())
        pending += plastic_heating.pending(old_points, old_place[i]);
      plastic_heating.settle(material_points, i, old_share[i], pending,
                             *state.temperature->node(node_of(i)));
    }
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::renew_reference(const NodalVector &position,
                                                        const std::vector<unsigned int> &old_place)
  {
    // New particles have come from the initial configuration with the rows that they have there.
    Neighbourhoods<dim> at_start;
    at_start.set_symmetry(symmetry);
    Stencils initial;
    at_start.search(particle_global, spread_initial_positions(), initial_support, communicator,
                    initial);
    IndexSet required(n_global_nodes);
    required.add_indices(at_start.global_nodes().begin(), at_start.global_nodes().end());
    const auto partition = std::make_shared<const NodePartition>(
        owned_nodes, required, communicator, symmetry, at_start.images());
    if (bonds)
      bonds->remove_unbonded(partition, at_start, initial);
    initial.rank_deficient_rows.clear();
    for (const BasisDefect &defect :
         moving_least_squares.compute(at_start.nodes(), at_start.position_at_search().data(),
                                      at_start.support_at_search().data(), initial, false))
      initial.rank_deficient_rows.push_back(defect.row);
    if (bonds)
      bonds->measure_rows(initial);

    at_start.set_partition(*partition, initial);
    NodalVector present;
    present.reinit(partition, node_stride, ReflectionParity::point);
    present_position.resize(particle_global.size() * node_stride);
    for (unsigned int i = 0; i < initial.n_particles(); ++i)
    {
      const unsigned int node = initial.particle_node[i]; // owned: the same in all partitions
      std::copy_n(position.node(node), node_stride,
                  present_position.begin() + std::ptrdiff_t(i) * node_stride);
      std::copy_n(position.node(node), node_stride, present.node(node));
    }
    present.update_ghosts();
    for (unsigned int i = 0; i < initial.n_particles(); ++i)
    {
      if (old_place[i] == is_new_particle && !initial.is_rigid(i))
      {
        const Tensor<2, dim> deformation = row_deformation<dim>(initial, i, present);
        if (determinant(deformation) > 0.)
          reference_deformation[i] = deformation;
      }
      stretch_support(i);
    }
    steps_since_rebuild = 0;
  }

  template void MomentumConsistentParticle<2>::add_particles(const CellSelection<2> &,
                                                             const NodalVector &,
                                                             const StateTransfer *);
  template void MomentumConsistentParticle<3>::add_particles(const CellSelection<3> &,
                                                             const NodalVector &,
                                                             const StateTransfer *);
} // namespace tombolo
