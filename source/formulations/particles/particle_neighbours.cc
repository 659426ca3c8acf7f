// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/support_size.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MomentumConsistentParticle<dim>::find_neighbours(const std::vector<double> &positions)
  {
    const bool has_broken = bonds && bonds->any();
    if (has_broken)
      bonds->prepare_search(partition_of_rows(), neighbourhoods, shape);
    neighbourhoods.search(particle_global, positions, present_support, communicator, shape);
    if (bonds)
      bonds->finish_search(has_broken ? partition_of_rows() : nullptr, neighbourhoods, shape);
    compute_shape_functions(neighbourhoods.position_at_search().data(),
                            neighbourhoods.support_at_search().data());
    make_gradients_consistent(positions);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::follow_deformation(const NodalVector &position)
  {
    if (!shape.inverse_deformation_is_current)
      NodalSmoothing::update_inverse_deformation<dim>(position.data(), shape);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Tensor<2, dim> total = deformation_since_reference(i) * reference_deformation[i];
      reference_deformation[i] = total;
      stretch_support(i);
    }
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::stretch_support(const unsigned int i)
  {
    double row_major[dim * dim];
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        row_major[a * dim + b] = reference_deformation[i][a][b];
    SupportSize::stretch<dim>(row_major, initial_support.data() + std::size_t(i) * node_stride,
                              present_support.data() + std::size_t(i) * node_stride);
  }

  template <int dim>
  Tensor<2, dim>
  MomentumConsistentParticle<dim>::deformation_since_reference(const unsigned int i) const
  {
    Tensor<2, dim> inverse_deformation;
    const double *const rows = shape.inverse_deformation.data() + 3 * node_stride * std::size_t(i);
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        inverse_deformation[a][b] = rows[a * node_stride + b];
    return invert(inverse_deformation);
  }

  template <int dim>
  bool MomentumConsistentParticle<dim>::rebuild_is_due(const NodalVector &position)
  {
    ++steps_since_rebuild;
    switch (configuration)
    {
    case Configuration::total_lagrangian:
      return false;
    case Configuration::current:
      return true;
    default:
      break;
    }
    if (rebuild_interval > 0 && steps_since_rebuild >= rebuild_interval)
      return true;
    // The measure needs a sweep and a reduction; every few steps is often enough, since a step
    // strains by far less than any useful threshold.
    constexpr unsigned int look_interval = 5;
    if (rebuild_deformation == 0. || steps_since_rebuild % look_interval != 0)
      return false;
    if (!shape.inverse_deformation_is_current)
      NodalSmoothing::update_inverse_deformation<dim>(position.data(), shape);
    double largest = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Tensor<2, dim> deformation = deformation_since_reference(i);
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          largest = std::max(largest, std::abs(deformation[a][b] - (a == b ? 1. : 0.)));
    }
    return Utilities::MPI::max(largest, communicator) > rebuild_deformation;
  }

  template <int dim>
  NeighbourhoodChange
  MomentumConsistentParticle<dim>::update_neighbourhoods(const NodalVector &position)
  {
    const NeighbourhoodChange of_rows = update_rows(position);
    if (!self_contact)
      return of_rows;
    if (of_rows != NeighbourhoodChange::none)
      self_contact->forget_fragments();
    if (!self_contact->update(position, has_broken_bonds()))
      return of_rows;
    return of_rows == NeighbourhoodChange::none ? NeighbourhoodChange::ghosts
                                                : NeighbourhoodChange::neighbours;
  }

  template <int dim>
  NeighbourhoodChange MomentumConsistentParticle<dim>::update_rows(const NodalVector &position)
  {
    has_started = true;
    bool has_broken = bonds && break_bonds(position);
    if (bonds)
      has_broken = isolate_distorted(position) || has_broken;
    if (!rebuild_is_due(position))
      return has_broken ? NeighbourhoodChange::values : NeighbourhoodChange::none;
    steps_since_rebuild = 0;
    prepare_change();
    follow_deformation(position);
    if (zero_energy_stabilization.is_on())
      zero_energy_stabilization.restart(material_points);
    std::vector<double> &positions = present_position;
    positions.resize(particle_global.size() * node_stride);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const auto place = std::ptrdiff_t(i) * node_stride;
      std::copy_n(position.node(shape.particle_node[i]), node_stride, positions.begin() + place);
      std::copy_n(present_support.begin() + place, node_stride,
                  support_of_node.node(shape.particle_node[i]));
    }
    if (neighbourhoods.candidates_hold(positions, present_support, communicator))
    {
      support_of_node.update_ghosts();
      compute_shape_functions(position.data(), support_of_node.data());
      make_gradients_consistent(position);
      release_debris();
      if (bonds)
        isolate_distorted(position);
      return NeighbourhoodChange::values;
    }
    find_neighbours(positions);
    release_debris();
    if (bonds && bonds->any())
    {
      // Rows have the numbers of the search yet.
      const auto partition = partition_of_rows();
      set_partition(*partition);
      NodalVector at_rebuild;
      at_rebuild.reinit(partition, node_stride, ReflectionParity::point);
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        std::copy_n(positions.begin() + std::ptrdiff_t(i) * node_stride, node_stride,
                    at_rebuild.node(shape.particle_node[i]));
      at_rebuild.update_ghosts();
      isolate_distorted(at_rebuild);
    }
    return NeighbourhoodChange::neighbours;
  }

  template <int dim>
  std::shared_ptr<const NodePartition> MomentumConsistentParticle<dim>::partition_of_rows() const
  {
    return std::make_shared<const NodePartition>(owned_nodes, required_nodes(), communicator,
                                                 symmetry, required_images());
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::compute_in_reference(NodalVector &buffer)
  {
    const bool is_rebuilt = !present_position.empty();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const auto place = std::ptrdiff_t(i) * node_stride;
      const unsigned int node = shape.particle_node[i];
      if (is_rebuilt)
        std::copy_n(present_position.begin() + place, node_stride, buffer.node(node));
      else
        for (unsigned int d = 0; d < dim; ++d)
          buffer.node(node)[d] = initial_positions[i][d];
      std::copy_n(present_support.begin() + place, node_stride, support_of_node.node(node));
    }
    buffer.update_ghosts();
    support_of_node.update_ghosts();
    compute_shape_functions(buffer.data(), support_of_node.data());
    make_gradients_consistent(buffer);
  }

  template <int dim>
  bool MomentumConsistentParticle<dim>::break_bonds(const NodalVector &position)
  {
    if (!bonds->is_due())
      return false;
    std::vector<Tensor<2, 3>> deformation;
    if (bonds->needs_deformation())
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        Tensor<2, dim> since_reference = row_deformation<dim>(shape, i, position);
        if (shape.is_rigid(i))
          since_reference = unit_symmetric_tensor<dim>();
        const Tensor<2, dim> total = since_reference * reference_deformation[i];
        Tensor<2, 3> full = unit_symmetric_tensor<3>();
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            full[a][b] = total[a][b];
        deformation.push_back(full);
      }
    if (!bonds->break_bonds(position, particle_global, initial_positions, deformation,
                            neighbourhoods, shape, material_points))
      return false;
    renew_broken_rows(position.partition());
    return true;
  }

  template <int dim>
  bool MomentumConsistentParticle<dim>::isolate_distorted(const NodalVector &position)
  {
    // What one loses, others lose too; each time there is one particle less that can.
    bool has_changed = false;
    while (
        bonds->isolate_distorted(position, particle_global, neighbourhoods, shape, material_points))
    {
      renew_broken_rows(position.partition());
      has_changed = true;
    }
    return has_changed;
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::renew_broken_rows(
      const std::shared_ptr<const NodePartition> &partition)
  {
    prepare_change();
    bonds->refuse_unbonded(partition, neighbourhoods, shape);
    bonds->remove_broken(partition, neighbourhoods, shape);
    NodalVector reference;
    reference.reinit(partition, node_stride, ReflectionParity::point);
    compute_in_reference(reference);
    release_debris();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::prepare_change()
  {
    if (before_change)
      before_change();
    if (bonds && bonds->any())
      former_rows.remember(shape);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::set_before_change(const std::function<void()> &to_call)
  {
    before_change = to_call;
  }

  template <int dim>
  std::vector<unsigned int> MomentumConsistentParticle<dim>::debris() const
  {
    return bonds ? bonds->debris(shape) : std::vector<unsigned int>();
  }

  template <int dim>
  LeavingParticles MomentumConsistentParticle<dim>::take_leaving_particles()
  {
    return bonds ? former_rows.leaving(shape, bonds->debris(shape)) : LeavingParticles();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::release_debris()
  {
    if (bonds)
      bonds->release_debris(shape, *part_material, plastic_heating.temperature(material_points),
                            initial_volume, material_points);
  }

  template <int dim>
  BondCounts MomentumConsistentParticle<dim>::bond_counts() const
  {
    return bonds ? bonds->counts(shape) : BondCounts();
  }

  template dealii::Tensor<2, 2>
  MomentumConsistentParticle<2>::deformation_since_reference(unsigned int) const;
  template std::shared_ptr<const NodePartition>
  MomentumConsistentParticle<2>::partition_of_rows() const;
  template void MomentumConsistentParticle<2>::find_neighbours(const std::vector<double> &);
  template void MomentumConsistentParticle<2>::follow_deformation(const NodalVector &);
  template void MomentumConsistentParticle<2>::stretch_support(unsigned int);
  template bool MomentumConsistentParticle<2>::rebuild_is_due(const NodalVector &);
  template NeighbourhoodChange
  MomentumConsistentParticle<2>::update_neighbourhoods(const NodalVector &);
  template NeighbourhoodChange MomentumConsistentParticle<2>::update_rows(const NodalVector &);
  template void MomentumConsistentParticle<2>::compute_in_reference(NodalVector &);
  template bool MomentumConsistentParticle<2>::break_bonds(const NodalVector &);
  template bool MomentumConsistentParticle<2>::isolate_distorted(const NodalVector &);
  template void
  MomentumConsistentParticle<2>::renew_broken_rows(const std::shared_ptr<const NodePartition> &);
  template void MomentumConsistentParticle<2>::release_debris();
  template void MomentumConsistentParticle<2>::prepare_change();
  template void MomentumConsistentParticle<2>::set_before_change(const std::function<void()> &);
  template std::vector<unsigned int> MomentumConsistentParticle<2>::debris() const;
  template LeavingParticles MomentumConsistentParticle<2>::take_leaving_particles();
  template BondCounts MomentumConsistentParticle<2>::bond_counts() const;
  template dealii::Tensor<2, 3>
  MomentumConsistentParticle<3>::deformation_since_reference(unsigned int) const;
  template std::shared_ptr<const NodePartition>
  MomentumConsistentParticle<3>::partition_of_rows() const;
  template void MomentumConsistentParticle<3>::find_neighbours(const std::vector<double> &);
  template void MomentumConsistentParticle<3>::follow_deformation(const NodalVector &);
  template void MomentumConsistentParticle<3>::stretch_support(unsigned int);
  template bool MomentumConsistentParticle<3>::rebuild_is_due(const NodalVector &);
  template NeighbourhoodChange
  MomentumConsistentParticle<3>::update_neighbourhoods(const NodalVector &);
  template NeighbourhoodChange MomentumConsistentParticle<3>::update_rows(const NodalVector &);
  template void MomentumConsistentParticle<3>::compute_in_reference(NodalVector &);
  template bool MomentumConsistentParticle<3>::break_bonds(const NodalVector &);
  template bool MomentumConsistentParticle<3>::isolate_distorted(const NodalVector &);
  template void
  MomentumConsistentParticle<3>::renew_broken_rows(const std::shared_ptr<const NodePartition> &);
  template void MomentumConsistentParticle<3>::release_debris();
  template void MomentumConsistentParticle<3>::prepare_change();
  template void MomentumConsistentParticle<3>::set_before_change(const std::function<void()> &);
  template std::vector<unsigned int> MomentumConsistentParticle<3>::debris() const;
  template LeavingParticles MomentumConsistentParticle<3>::take_leaving_particles();
  template BondCounts MomentumConsistentParticle<3>::bond_counts() const;
} // namespace tombolo
