// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/model/step_limit.h>
#include <tombolo/physics/mechanics/lobpcg.h>

namespace tombolo
{
  /** @p force := the nodal forces of the elastic stiffness of all parts in a @p motion over a time
   * step at the present positions, as their formulations have them. @p motion has current ghosts.
   * Where a cell or particle of this rank is turned inside out the forces of its part are left out:
   * were it thrown here, the other ranks would wait in their exchanges. The stresses there fail in
   * the same step, which ends the run on all ranks. With @p by_groups it is that of
   * StepGroups, which bounds the step. Collective. */
  template <int dim>
  void apply_elastic_stiffness(const Model<dim> &model, const NodalVector &motion,
                               const double time_step, NodalVector &force,
                               const bool by_groups = false)
  {
    Assembly<dim>(model.parts)
        .assemble(*model.bridge, motion, force,
                  [&](const Part<dim> &part, const NodalVector &seen, NodalVector &sum)
                  {
                    const NodalVector &x = model.state.position;
                    try
                    {
                      if (by_groups)
                        model.step_groups.apply_elastic_stiffness(
                            static_cast<std::size_t>(&part - model.parts.data()), *part.formulation,
                            x, seen, time_step, sum);
                      else
                        part.formulation->apply_elastic_stiffness(x, seen, time_step, sum);
                    }
                    catch (const RunError &)
                    {}
                  });
  }

  /** The next number below with a short mantissa: a different order of summation changes the last
   * digits of an estimate and must not change the step. */
  double round_down(double step);

  /** Eq. (41) of Pan et al. 2019 without its factor: the smallest ratio of characteristic length
   * (an element's, or a particle's support) to wave speed, over the ratio of a cell that has longer
   * steps. Not a bound of the stable step: at free corners of particles with ν ≥ 0.3, and for
   * dilations from 1.9, it is larger. Collective. */
  template <int dim>
  StepLimit courant_limit(const Model<dim> &model);

  /**
   * The stable step from the spectrum of the real update operator, 2/√λ with λ the largest
   * eigenvalue of A = Φ_γ M⁻¹ K S_γ, which is self-adjoint in the inner product of M̂
   * (doc/method.md, section 8). Artificial viscosity C acts on velocities that lag by half a step:
   * the limit is then the Δt at which the largest eigenvalue of Δt² K + 2 Δt C is 4, found by
   * Newton's method.
   *
   * λ is found by Lobpcg, which approaches it from below, so that the result is scaled
   * by a margin. The first call starts from noise, a later one from the last eigenvector with some
   * noise, since another region may limit the step by now.
   */
  template <int dim>
  class SpectralEstimator
  {
  public:
    /** Of the step of the model, or, without @p by_groups, of one common step of all cells. */
    explicit SpectralEstimator(const Entries &e, bool by_groups = true);
    /** The largest stable step at the present configuration, before any safety factor, the same on
     * all ranks, with the entity that limits it. Where there is viscosity the iteration begins with
     * the @p expected step, or with the Courant limit if it is zero. Keeps information for later
     * calls. Collective. */
    StepLimit estimate(const Model<dim> &model, double expected = 0.);

    /** Lists the results of earlier calls. */
    void list(Records &records, const Model<dim> &model);

    /** Applications of the operator in the last call. */
    unsigned int n_applications() const
    {
      return count;
    }

  private:
    /** Sets prescribed components of @p vector to zero, which leaves the motion that is free. */
    void remove_constrained(const Model<dim> &model, NodalVector &vector) const;
    /** @p result = A @p v_hat, which has current ghosts. */
    void apply(const Model<dim> &model, const NodalVector &v_hat, double time_step,
               NodalVector &result);
    /** Largest eigenvalue of A; the eigenvector goes into mode. */
    double largest_eigenvalue(const Model<dim> &model, double time_step, const Lobpcg::Stop &stop);
    /** The Rayleigh quotient of the mode in A. */
    double quotient(const Model<dim> &model, double time_step);
    /** mode·C mode of the normalized mode, of which quotient() is @p whole. */
    double viscous_part(const Model<dim> &model, double time_step, double whole);
    /** Names the node that moves most in the mode; the same on any number of ranks. */
    void find_entity(const Model<dim> &model, StepLimit &limit) const;

    bool by_groups;
    Lobpcg solver;
    unsigned int count = 0;
    unsigned int n_calls = 0;
    bool has_viscosity = false;
    NodalVector velocity, force;
  };
} // namespace tombolo
