// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/state/records.h>

#include <deal.II/base/tensor.h>

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
    KernelConfiguration(const Entries &e, const std::string &default_kind = "current");

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
    void reset(const ParticleSet<dim> &particles);

    /** From now on supports are the initial ones of @p particles, however these deform. */
    void fix_supports(const ParticleSet<dim> &particles);

    /** Counts a step. Whether the reference is to be renewed at @p position (current ghosts), the
     * same answer on all ranks. Brings the inverse deformation of @p shape up to date where it
     * needs it. Collective. */
    bool is_renewal_due(const NodalVector &position, const ParticleSet<dim> &particles,
                        Stencils &shape);

    /** Makes @p position (current ghosts) the reference: updates F and stretches the supports.
     * Where F follows the motion nothing is left to do. */
    void renew(const NodalVector &position, const ParticleSet<dim> &particles, Stencils &shape);

    /** The same for more particles: number i was number old_index[i], or is new where that is not
     * below the size of @p old, which holds the F of old particles. */
    void keep_deformation(const std::vector<dealii::Tensor<2, dim>> &old,
                          const std::vector<unsigned int> &old_index);
    void set_deformation(const unsigned int i, const dealii::Tensor<2, dim> &of_reference)
    {
      reference_deformation[i] = of_reference;
    }
    /** Stretches the initial support of all particles by F. */
    void stretch_supports(const ParticleSet<dim> &particles);
    /** Remembers where the particles are at @p position as that of the reference, and that no step
     * was made since. */
    void set_positions(const NodalVector &position, const Stencils &shape);

    /** Where the kernels are current and supports are fixed, nothing but outputs and bonds needs F:
     * whoever computes velocity gradients at the present positions multiplies it with what they
     * add to the deformation. Null otherwise: renew() does it. */
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
    bool is_renewed(MPI_Comm communicator) const;
    /** Volumes in the reference, det F times the initial ones [L^dim]. */
    std::vector<double> volumes(const ParticleSet<dim> &particles) const;

    /** F of particle @p i from the initial configuration to @p position (current ghosts); the part
     * since the reference counts as the identity in rank-deficient rows. */
    dealii::Tensor<2, dim> total_deformation(unsigned int i, const Stencils &shape,
                                             const NodalVector &position) const;

    /** Calls @p use with the number of each particle and the half widths that limits of the step
     * count with: those of its support as the deformation up to @p position would stretch it,
     * renewed or not, or half of them where supports are fixed, which are smoothing lengths then.
     */
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

    /** Lists the number of steps since the renewal. */
    void list(Records &records)
    {
      records.value("steps since rebuild", steps_since_renewal);
    }
    /** Writes or reads positions, supports and deformation of a renewed reference, as rows of
     * @p archive. */
    void serialize_reference(StateArchive &archive);

  private:
    void stretch_support(unsigned int i, const ParticleSet<dim> &particles);
    /** The initial support of particle @p i after the deformation @p total. */
    void stretched_support(unsigned int i, const ParticleSet<dim> &particles,
                           const dealii::Tensor<2, dim> &total, double *half_width) const;
    dealii::Tensor<2, dim> deformation_since_reference(unsigned int i, const Stencils &shape) const;

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
