// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/physics/statics/static_solver.h>
#include <tombolo/physics/statics/tangent_matrix.h>

#include <memory>
#include <string>

namespace tombolo
{
  /**
   * Newton's method with the consistent tangent (CellStiffness) and a line search. The first
   * iteration starts from the state at the beginning of the step and moves the prescribed
   * components with the body, so that no layer of cells is crushed by them; an unloading body is
   * then at its solution at once. The linear equations are solved by TangentMatrix.
   */
  template <int dim>
  class NewtonKrylov : public StaticSolver<dim>
  {
  public:
    explicit NewtonKrylov(const Entries &e);

    StaticSolution solve(StaticProblem<dim> &problem, double tolerance) override;
    bool was_easy(const StaticSolution &solution) const override;
    double further_evaluations() const override;
    void add_to_summary(Json &summary) const override;

  private:
    /** Adds the step @p change to @p displacement, or the part of it that makes |R| smaller, or its
     * power along the step, or the step that would follow by the same matrix. Returns the new |R|;
     * infinite where there is none. Collective. */
    double search_line(StaticProblem<dim> &problem, double norm, const NodalVector &change,
                       NodalVector &displacement);

    /** Finds @p change; where multigrid fails, by a factorization if the matrix is small enough for
     * it. Returns what went wrong; empty: nothing. Collective. */
    std::string solve_linear(StaticProblem<dim> &problem, bool is_driven, double target,
                             StaticSolution &solution);

    typename TangentMatrix<dim>::Solver solver;
    unsigned int max_iterations;
    std::unique_ptr<TangentMatrix<dim>> matrix; ///< with the first step
    NodalVector displacement, change, trial, next;
    unsigned long linear_iterations = 0, newton_iterations = 0;
    double cells_per_matrix = 0; ///< evaluations of cells that one assembly takes
  };
} // namespace tombolo
