// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/kernel_configuration.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/support_size.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  namespace
  {
    template <int dim>
    std::array<double, dim * dim> row_major(const Tensor<2, dim> &tensor)
    {
      std::array<double, dim * dim> result;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          result[a * dim + b] = tensor[a][b];
      return result;
    }
  } // namespace

  template <int dim>
  KernelConfiguration<dim>::KernelConfiguration(const Entries &e, const std::string &default_kind)
  {
    const std::string name =
        e.choice("Configuration", default_kind, "total Lagrangian|updated Lagrangian|current",
                 "The configuration in which kernels are: the initial one, one that is renewed now "
                 "and then (see the rebuild entries), or the current one.");
    kind = name == "total Lagrangian"     ? Kind::total_lagrangian
           : name == "updated Lagrangian" ? Kind::updated_lagrangian
                                          : Kind::current;
    if (e.when(kind == Kind::updated_lagrangian))
    {
      renewal_interval = e.integer(
          "Rebuild interval", "0", between(0, 1000000000),
          "Updated Lagrangian: the reference is renewed every so many steps; 0 is never.");
      renewal_deformation =
          e.number("Rebuild deformation", "0", between(0., 10.), "",
                   "Updated Lagrangian: the reference is renewed when a component of F - I since "
                   "the last renewal exceeds this at any particle; 0 is never.");
      e.refuse(renewal_interval == 0 && renewal_deformation == 0., "Configuration",
               "an updated Lagrangian kernel needs `Rebuild interval` or `Rebuild deformation`; "
               "with neither it is total Lagrangian");
    }
    stretch_limit =
        e.number("Support stretch limit", "0", between(0., 1000.), "",
                 "Updated Lagrangian or current: a support is at most so many times as wide, or as "
                 "narrow, as at the start, on each axis; 1 keeps it, and 0 is no limit: it "
                 "stretches as the body does since the start. For flows that stir: there who was "
                 "near is far away, and others are near instead.");
    e.refuse(stretch_limit > 0. && stretch_limit < 1., "Support stretch limit",
             "allowed are 0 and numbers from 1 on.");
    e.refuse(stretch_limit > 0. && is_total_lagrangian(), "Support stretch limit",
             "supports of a total Lagrangian kernel do not stretch.");
  }

  template <int dim>
  void KernelConfiguration<dim>::reset(const ParticleSet<dim> &particles)
  {
    half_widths = particles.initial_supports();
    reference_deformation.assign(particles.size(), unit_symmetric_tensor<dim>());
  }

  template <int dim>
  void KernelConfiguration<dim>::fix_supports(const ParticleSet<dim> &particles)
  {
    stretches_supports = false;
    half_widths = particles.initial_supports();
  }

  template <int dim>
  bool KernelConfiguration<dim>::is_renewal_due(const NodalVector &position,
                                                const ParticleSet<dim> &particles, Stencils &shape)
  {
    ++steps_since_renewal;
    switch (kind)
    {
    case Kind::total_lagrangian:
      return false;
    case Kind::current:
      return true;
    default:
      break;
    }
    if (renewal_interval > 0 && steps_since_renewal >= renewal_interval)
      return true;
    // The measure needs a sweep and a reduction; every few steps is often enough, since a step
    // strains by far less than any useful threshold.
    constexpr unsigned int check_interval = 5;
    if (renewal_deformation == 0. || steps_since_renewal % check_interval != 0)
      return false;
    if (!shape.inverse_deformation_is_current)
      NodalSmoothing::update_inverse_deformation<dim>(position.data(), shape);
    double largest = 0;
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Tensor<2, dim> since = deformation_since_reference(i, shape);
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          largest = std::max(largest, std::abs(since[a][b] - (a == b ? 1. : 0.)));
    }
    return Utilities::MPI::max(largest, particles.communicator()) > renewal_deformation;
  }

  template <int dim>
  void KernelConfiguration<dim>::renew(const NodalVector &position,
                                       const ParticleSet<dim> &particles, Stencils &shape)
  {
    if (deformation_of_motion() != nullptr)
      return;
    if (!shape.inverse_deformation_is_current)
      NodalSmoothing::update_inverse_deformation<dim>(position.data(), shape);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
    {
      const Tensor<2, dim> total = deformation_since_reference(i, shape) * reference_deformation[i];
      reference_deformation[i] = total;
      stretch_support(i, particles);
    }
  }

  template <int dim>
  void KernelConfiguration<dim>::keep_deformation(const std::vector<Tensor<2, dim>> &old,
                                                  const std::vector<unsigned int> &old_index)
  {
    for (std::size_t i = 0; i < old_index.size(); ++i)
      if (old_index[i] < old.size())
        reference_deformation[i] = old[old_index[i]];
  }

  template <int dim>
  void KernelConfiguration<dim>::stretch_supports(const ParticleSet<dim> &particles)
  {
    for (unsigned int i = 0; i < particles.size(); ++i)
      stretch_support(i, particles);
  }

  template <int dim>
  void KernelConfiguration<dim>::stretch_support(const unsigned int i,
                                                 const ParticleSet<dim> &particles)
  {
    if (stretches_supports)
      stretched_support(i, particles, reference_deformation[i],
                        half_widths.data() + std::size_t(i) * node_stride);
  }

  template <int dim>
  void KernelConfiguration<dim>::stretched_support(const unsigned int i,
                                                   const ParticleSet<dim> &particles,
                                                   const Tensor<2, dim> &total,
                                                   double *const half_width) const
  {
    const double *const initial =
        particles.initial_supports().data() + std::size_t(i) * node_stride;
    SupportSize::stretch<dim>(row_major(total).data(), initial, half_width);
    if (stretch_limit > 0.)
      for (unsigned int d = 0; d < dim; ++d)
        half_width[d] =
            std::clamp(half_width[d], initial[d] / stretch_limit, initial[d] * stretch_limit);
  }

  template <int dim>
  void KernelConfiguration<dim>::set_positions(const NodalVector &position, const Stencils &shape)
  {
    steps_since_renewal = 0;
    reference_position.resize(std::size_t(shape.n_particles()) * node_stride);
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      std::copy_n(position.node(shape.particle_node[i]), node_stride,
                  reference_position.begin() + std::ptrdiff_t(i) * node_stride);
  }

  template <int dim>
  Tensor<2, dim> KernelConfiguration<dim>::deformation_since_reference(const unsigned int i,
                                                                       const Stencils &shape) const
  {
    return invert(inverse_row_deformation<dim>(shape, i));
  }

  template <int dim>
  bool KernelConfiguration<dim>::is_renewed(const MPI_Comm communicator) const
  {
    // A rank can be without particles.
    return Utilities::MPI::max(reference_position.empty() ? 0 : 1, communicator) == 1;
  }

  template <int dim>
  std::vector<double> KernelConfiguration<dim>::volumes(const ParticleSet<dim> &particles) const
  {
    std::vector<double> result = particles.initial_volumes();
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] *= determinant(reference_deformation[i]);
    return result;
  }

  template <int dim>
  Tensor<2, dim> KernelConfiguration<dim>::total_deformation(const unsigned int i,
                                                             const Stencils &shape,
                                                             const NodalVector &position) const
  {
    if (shape.is_undeformed(i))
      return reference_deformation[i];
    return (shape.inverse_deformation_is_current ? deformation_since_reference(i, shape)
                                                 : row_deformation<dim>(shape, i, position)) *
           reference_deformation[i];
  }

  template <int dim>
  void KernelConfiguration<dim>::serialize_reference(StateArchive &archive)
  {
    std::vector<double> entries;
    for (const Tensor<2, dim> &of_particle : reference_deformation)
    {
      const auto of_tensor = row_major(of_particle);
      entries.insert(entries.end(), of_tensor.begin(), of_tensor.end());
    }
    archive.rows("position at rebuild", node_stride, reference_position);
    archive.rows("support at rebuild", node_stride, half_widths);
    archive.rows("deformation at rebuild", dim * dim, entries);
    if (!archive.is_reading())
      return;
    for (std::size_t i = 0; i < reference_deformation.size(); ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          reference_deformation[i][a][b] = entries[(i * dim + a) * dim + b];
  }

  template class KernelConfiguration<2>;
  template class KernelConfiguration<3>;
} // namespace tombolo
