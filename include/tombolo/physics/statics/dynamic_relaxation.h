// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/physics/statics/static_solver.h>
#include <tombolo/physics/statics/tangent_matrix.h>

#include <memory>

namespace tombolo
{
  /**
   * Dynamic relaxation with kinetic damping: explicit steps of size one of a body with masses of
   * its own, m = Σ_j |K_ij| times 0.3 by row sums of the stiffness, with which every mode is stable
   * at that step (Gershgorin), from rest; velocities are put to zero at each maximum of the kinetic
   * energy, and the body where it was about then, in the middle between the last two places before
   * the energy fell (Barnes, Int. J. Space Struct. 14, 89-104, 1999): without that, vibrations of
   * three steps would last. It solves the same equations as NewtonKrylov, each evaluation from the
   * material points at the start of the step, so that the path of the relaxation leaves no plastic
   * strain. The baseline: it needs no linear solver, but thousands of evaluations.
   */
  template <int dim>
  class DynamicRelaxation : public StaticSolver<dim>
  {
  public:
    explicit DynamicRelaxation(const Entries &e);

    StaticSolution solve(StaticProblem<dim> &problem, double tolerance) override;
    bool was_easy(const StaticSolution &solution) const override;
    double further_evaluations() const override;
    void add_to_summary(Json &summary) const override;

  private:
    /** After a step that has lost kinetic energy. */
    void go_to_rest(const StaticProblem<dim> &problem);
    /** One step of the relaxation: displacement and velocity by the residual. Returns the kinetic
     * energy. Collective. */
    double advance(const StaticProblem<dim> &problem, double prescribed_share, bool is_from_rest);

    unsigned int max_iterations;
    std::unique_ptr<TangentMatrix<dim>> matrix; ///< for the masses
    NodalVector displacement, velocity;
    unsigned long iterations = 0, n_restarts = 0;
    double cells_per_matrix = 0;
  };
} // namespace tombolo
