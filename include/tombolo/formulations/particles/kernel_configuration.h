// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/approximation/support_size.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/state/records.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The configuration in which the kernels of the particles of one part are: the initial one (total
   * Lagrangian), one that is renewed by a criterion (updated Lagrangian), or the present one at
   * each step. It holds the deformation gradient F of each particle from the initial configuration
   * to this reference, and the supports stretched by it (SupportSize::stretch), within a limit if
   * one is given. Without parameters it is total Lagrangian.
   */
  template <int dim>
  class KernelConfiguration
  {
  public:
    KernelConfiguration() = default;
    /** Throws InputError where an updated Lagrangian configuration has no criterion. */
    KernelConfiguration(const Entries &e, const std::string &default_kind)
    {
      const std::string name = e.choice(
          "Configuration", default_kind, "total Lagrangian|updated Lagrangian|current",
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
      stretch_limit = e.number(
          "Support stretch limit", "0", between(0., 1000.), "",
          "Updated Lagrangian or current: a support is at most so many times as wide, or as "
          "narrow, as at the start, on each axis; 1 keeps it, and 0 is no limit: it "
          "stretches as the body does since the start. For flows that stir: there who was "
          "near is far away, and others are near instead.");
      e.refuse(stretch_limit > 0. && stretch_limit < 1., "Support stretch limit",
               "allowed are 0 and numbers from 1 on.");
      e.refuse(stretch_limit > 0. && is_total_lagrangian(), "Support stretch limit",
               "supports of a total Lagrangian kernel do not stretch.");
    }

    bool is_total_lagrangian() const
    {
      return kind == Kind::total_lagrangian;
    }
    /** Renewed at each step. */
    bool is_current() const
    {
      return kind == Kind::current;
    }

    /** Makes the initial configuration the reference of @p particles. */
    void reset(const ParticleSet<dim> &particles)
    {
      half_widths = particles.initial_supports();
      reference_deformation.assign(particles.size(), dealii::unit_symmetric_tensor<dim>());
    }

    /** From now on supports are the initial ones of @p particles, however these deform. */
    void fix_supports(const ParticleSet<dim> &particles)
    {
      stretches_supports = false;
      half_widths = particles.initial_supports();
    }

    /** Counts a step. Whether the reference is to be renewed at @p position (current ghosts), alike
     * on all ranks. Updates the inverse deformation of @p shape if needed. Collective. */
    bool is_renewal_due(const NodalVector &position, const ParticleSet<dim> &particles,
                        Stencils &shape)
    {
      ++steps_since_renewal;
      if (kind != Kind::updated_lagrangian)
        return is_current();
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
        const dealii::Tensor<2, dim> since = deformation_since_reference(i, shape);
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            largest = std::max(largest, std::abs(since[a][b] - (a == b ? 1. : 0.)));
      }
      return dealii::Utilities::MPI::max(largest, particles.communicator()) > renewal_deformation;
    }

    /** Makes @p position (current ghosts) the reference: updates F and stretches the supports.
     * Where F follows the motion nothing is left to do. */
    void renew(const NodalVector &position, const ParticleSet<dim> &particles, Stencils &shape)
    {
      if (deformation_of_motion() != nullptr)
        return;
      if (!shape.inverse_deformation_is_current)
        NodalSmoothing::update_inverse_deformation<dim>(position.data(), shape);
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        const dealii::Tensor<2, dim> total =
            deformation_since_reference(i, shape) * reference_deformation[i];
        reference_deformation[i] = total;
        stretch_support(i, particles);
      }
    }

    /** The same for more particles: number i was number old_index[i], or is new where that is not
     * below the size of @p old, which holds the F of old particles. */
    void keep_deformation(const std::vector<dealii::Tensor<2, dim>> &old,
                          const std::vector<unsigned int> &old_index)
    {
      for (std::size_t i = 0; i < old_index.size(); ++i)
        if (old_index[i] < old.size())
          reference_deformation[i] = old[old_index[i]];
    }
    void set_deformation(const unsigned int i, const dealii::Tensor<2, dim> &new_deformation)
    {
      reference_deformation[i] = new_deformation;
    }
    void stretch_supports(const ParticleSet<dim> &particles)
    {
      for (unsigned int i = 0; i < particles.size(); ++i)
        stretch_support(i, particles);
    }
    /** Stores the positions of the particles as the reference, with no step since. */
    void set_positions(const NodalVector &position, const Stencils &shape)
    {
      steps_since_renewal = 0;
      reference_position.resize(std::size_t(shape.n_particles()) * node_stride);
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        std::copy_n(position.node(shape.particle_node[i]), node_stride,
                    reference_position.begin() + std::ptrdiff_t(i) * node_stride);
    }

    /** Where the kernels are current and supports are fixed, nothing but outputs and bonds needs F:
     * the sweep that computes velocity gradients at the present positions multiplies it with what
     * they add to the deformation. Null otherwise: renew() does it. */
    std::vector<dealii::Tensor<2, dim>> *deformation_of_motion()
    {
      return follows_motion() ? &reference_deformation : nullptr;
    }
    /** Whether F is kept so. */
    bool follows_motion() const
    {
      return is_current() && !stretches_supports;
    }

    /** F of each particle from the initial configuration to the reference. */
    const std::vector<dealii::Tensor<2, dim>> &deformation() const
    {
      return reference_deformation;
    }
    /** Half widths of the supports in the reference, node_stride each [L]. */
    const std::vector<double> &supports() const
    {
      return half_widths;
    }
    /** Positions in the reference, node_stride each [L]; empty until the first renewal. */
    const std::vector<double> &positions() const
    {
      return reference_position;
    }
    /** Whether the reference was renewed on any rank. Collective. */
    bool is_renewed(const MPI_Comm communicator) const
    {
      // A rank can be without particles.
      return dealii::Utilities::MPI::max(reference_position.empty() ? 0 : 1, communicator) == 1;
    }
    /** Volumes in the reference, det F times the initial ones [L^dim]. */
    std::vector<double> volumes(const ParticleSet<dim> &particles) const
    {
      std::vector<double> result = particles.initial_volumes();
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] *= determinant(reference_deformation[i]);
      return result;
    }

    /** F of particle @p i from the initial configuration to @p position (current ghosts); the part
     * since the reference counts as the identity in rank-deficient rows. */
    dealii::Tensor<2, dim> total_deformation(const unsigned int i, const Stencils &shape,
                                             const NodalVector &position) const
    {
      if (shape.is_undeformed(i))
        return reference_deformation[i];
      return (shape.inverse_deformation_is_current ? deformation_since_reference(i, shape)
                                                   : row_deformation<dim>(shape, i, position)) *
             reference_deformation[i];
    }

    /** Calls @p use with the number of each particle and the half widths that limits of the step
     * count with: those of its support as stretched by the deformation up to @p position, renewed
     * or not, or half of them where supports are fixed, which are smoothing lengths then. */
    template <typename Use>
    void for_present_supports(const ParticleSet<dim> &particles, const Stencils &shape,
                              const NodalVector &position, const Use &use) const
    {
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        double half_width[node_stride];
        stretched_support(i, particles, total_deformation(i, shape, position), half_width);
        if (!stretches_supports)
          for (unsigned int d = 0; d < dim; ++d)
            half_width[d] *= 0.5;
        use(i, half_width);
      }
    }

    void list(Records &records)
    {
      records.value("steps since rebuild", steps_since_renewal);
    }
    /** Writes or reads a renewed reference as rows of @p archive. */
    void serialize_reference(StateArchive &archive)
    {
      constexpr std::size_t n = dim * dim;
      std::vector<double> entries(n * reference_deformation.size());
      for (std::size_t i = 0; i < reference_deformation.size(); ++i)
        std::copy_n(&reference_deformation[i][0][0], n, &entries[i * n]);
      archive.rows("position at rebuild", node_stride, reference_position);
      archive.rows("support at rebuild", node_stride, half_widths);
      archive.rows("deformation at rebuild", n, entries);
      if (!archive.is_reading())
        return;
      for (std::size_t i = 0; i < reference_deformation.size(); ++i)
        std::copy_n(&entries[i * n], n, &reference_deformation[i][0][0]);
    }

  private:
    void stretch_support(const unsigned int i, const ParticleSet<dim> &particles)
    {
      if (stretches_supports)
        stretched_support(i, particles, reference_deformation[i],
                          half_widths.data() + std::size_t(i) * node_stride);
    }
    /** The initial support of particle @p i after the deformation @p total. */
    void stretched_support(const unsigned int i, const ParticleSet<dim> &particles,
                           const dealii::Tensor<2, dim> &total, double *const half_width) const
    {
      const double *const initial =
          particles.initial_supports().data() + std::size_t(i) * node_stride;
      SupportSize::stretch<dim>(&total[0][0], initial, half_width);
      if (stretch_limit > 0.)
        for (unsigned int d = 0; d < dim; ++d)
          half_width[d] =
              std::clamp(half_width[d], initial[d] / stretch_limit, initial[d] * stretch_limit);
    }
    dealii::Tensor<2, dim> deformation_since_reference(const unsigned int i,
                                                       const Stencils &shape) const
    {
      return invert(inverse_row_deformation<dim>(shape, i));
    }

    enum class Kind
    {
      total_lagrangian,
      updated_lagrangian,
      current
    } kind = Kind::total_lagrangian;
    bool stretches_supports = true;
    double stretch_limit = 0; // of supports over the initial ones; 0 is none
    unsigned int renewal_interval = 0;
    double renewal_deformation = 0;
    unsigned int steps_since_renewal = 0;

    std::vector<double> half_widths;        // node_stride each
    std::vector<double> reference_position; // node_stride each
    std::vector<dealii::Tensor<2, dim>> reference_deformation;
  };
} // namespace tombolo
