// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_fracture.h>

#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ParticleFracture<dim>::ParticleFracture(const Section &section, const ParticleSet<dim> &particles,
                                          const KernelConfiguration<dim> &kernel,
                                          ParticleRows<dim> &rows, PartPoints &points)
      : particles(particles), kernel(kernel), rows(rows), points(points),
        bonds(Bonds<dim>::create(section))
  {}

  template <int dim>
  void ParticleFracture<dim>::prepare_change()
  {
    if (before_change)
      before_change();
    if (has_broken_bonds())
      former_rows.remember(rows.stencils());
  }

  template <int dim>
  void ParticleFracture<dim>::finish_search()
  {
    if (bonds)
      bonds->finish_search(has_broken_bonds() ? rows.partition(particles) : nullptr,
                           rows.neighbourhoods(), rows.stencils());
  }

  template <int dim>
  bool ParticleFracture<dim>::update(const NodalVector &position)
  {
    if (!bonds)
      return false;
    const bool has_broken = break_bonds(position);
    return isolate_distorted(position) || has_broken;
  }

  template <int dim>
  bool ParticleFracture<dim>::break_bonds(const NodalVector &position)
  {
    if (!bonds->is_due())
      return false;
    const Stencils &shape = rows.stencils();
    std::vector<Tensor<2, 3>> deformation;
    if (bonds->needs_deformation())
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        const Tensor<2, dim> total = kernel.total_deformation(i, shape, position);
        Tensor<2, 3> full = unit_symmetric_tensor<3>();
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            full[a][b] = total[a][b];
        deformation.push_back(full);
      }
    if (!bonds->break_bonds(position, particles.nodes(), particles.initial_positions(), deformation,
                            rows.neighbourhoods(), shape, points.points()))
      return false;
    renew_broken_rows(position.partition());
    return true;
  }

  template <int dim>
  bool ParticleFracture<dim>::isolate_distorted(const NodalVector &position)
  {
    if (!bonds)
      return false;
    // What one loses, others lose too; each time there is one particle less that can.
    bool has_changed = false;
    while (bonds->isolate_distorted(position, particles.nodes(), rows.neighbourhoods(),
                                    rows.stencils(), points.points()))
    {
      renew_broken_rows(position.partition());
      has_changed = true;
    }
    return has_changed;
  }

  template <int dim>
  void ParticleFracture<dim>::isolate_distorted_in_reference()
  {
    if (!bonds || !bonds->can_isolate())
      return;
    const auto partition = rows.partition(particles);
    rows.set_partition(*partition);
    const Stencils &shape = rows.stencils();
    isolate_distorted(
        nodal_field(partition, Quantity::position, shape.particle_node,
                    [&](const std::size_t i, double *const place)
                    { std::copy_n(&kernel.positions()[i * node_stride], node_stride, place); }));
  }

  template <int dim>
  void
  ParticleFracture<dim>::renew_broken_rows(const std::shared_ptr<const NodePartition> &partition)
  {
    prepare_change();
    bonds->refuse_unbonded(partition, rows.neighbourhoods(), rows.stencils());
    bonds->remove_broken(partition, rows.neighbourhoods(), rows.stencils());
    NodalVector reference(partition, Quantity::position);
    rows.compute_in_reference(particles, kernel, reference);
    release_debris();
  }

  template <int dim>
  void ParticleFracture<dim>::release_debris()
  {
    if (bonds && !bonds->debris(rows.stencils()).empty())
      bonds->release_debris(rows.stencils(), points.elastic_energies(), particles.initial_volumes(),
                            points.points());
  }

  template <int dim>
  bool
  ParticleFracture<dim>::complete_reading(const std::shared_ptr<const NodePartition> &partition)
  {
    if (!has_broken_bonds())
      return false;
    bonds->remove_broken(partition, rows.neighbourhoods(), rows.stencils());
    return true;
  }

  template class ParticleFracture<2>;
  template class ParticleFracture<3>;
} // namespace tombolo
