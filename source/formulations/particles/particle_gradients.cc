// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MomentumConsistentParticle<dim>::make_gradients_consistent(const NodalVector &position)
  {
    if (!has_consistent_gradients)
      return;
    // A traction t enters the nodal forces as Φᵀ(t s), and so do the forces of elements with the
    // trace bridge; with the paper's they stay where they are. A prescribed particle, and any one
    // where nothing is smoothed, has a unit row of Φ.
    const auto &partition = position.partition();
    NodalVector areas, target;
    areas.reinit(partition);
    target.reinit(partition);
    if (!smoothing_settings.is_active)
      boundary.add_areas(position, target, target);
    else
      boundary.add_areas(position, areas, trace_bridge ? areas : target);
    areas.add_to_owners();
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const double *const area = areas.node(shape.particle_node[i]);
      const auto add = [&](const unsigned int node, const double share)
      {
        for (unsigned int d = 0; d < dim; ++d)
          target.node(node)[d] += share * area[d];
      };
      if (has_unit_row[i])
        add(shape.particle_node[i], 1.);
      else if (std::any_of(area, area + dim,
                           [](const double component) { return component != 0.; }))
      {
        const Stencils::Row row = shape.row(i);
        for (unsigned int k = 0; k < row.size; ++k)
          add(row.neighbour[k], row.value[k]);
      }
    }
    target.add_to_owners();

    // Those of the reference; material points may have gone on since.
    std::vector<double> volume = initial_volume;
    for (unsigned int i = 0; i < volume.size(); ++i)
      volume[i] *= determinant(reference_deformation[i]);
    constexpr unsigned int largest_n_iterations = 20000;
    consistency = ConsistentGradients<dim>::establish(volume, position, target, gradient_tolerance,
                                                      largest_n_iterations, shape);
  }

  template <int dim>
  void
  MomentumConsistentParticle<dim>::make_gradients_consistent(const std::vector<double> &positions)
  {
    if (!has_consistent_gradients)
      return;
    const auto partition = std::make_shared<const NodePartition>(
        owned_nodes, required_nodes(), communicator, symmetry, required_images());
    set_partition(*partition);
    NodalVector position;
    position.reinit(partition, node_stride, ReflectionParity::point);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      std::copy_n(positions.begin() + std::ptrdiff_t(i) * node_stride, node_stride,
                  position.node(shape.particle_node[i]));
    position.update_ghosts();
    make_gradients_consistent(position);
  }

  template <int dim>
  const GradientConsistency *MomentumConsistentParticle<dim>::gradient_consistency() const
  {
    return has_consistent_gradients ? &consistency : nullptr;
  }

  template void MomentumConsistentParticle<2>::make_gradients_consistent(const NodalVector &);
  template void MomentumConsistentParticle<3>::make_gradients_consistent(const NodalVector &);
  template void
  MomentumConsistentParticle<2>::make_gradients_consistent(const std::vector<double> &);
  template void
  MomentumConsistentParticle<3>::make_gradients_consistent(const std::vector<double> &);
  template const GradientConsistency *MomentumConsistentParticle<2>::gradient_consistency() const;
  template const GradientConsistency *MomentumConsistentParticle<3>::gradient_consistency() const;
} // namespace tombolo
