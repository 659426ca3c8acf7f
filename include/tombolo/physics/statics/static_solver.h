// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/base/json.h>
#include <tombolo/physics/statics/static_problem.h>

#include <string>

namespace tombolo
{
  /** How the solution of a static step went. */
  struct StaticSolution
  {
    bool has_converged = false;
    unsigned int n_iterations = 0;
    double residual = 0;      ///< |R| over the scale of forces
    std::string report;       ///< norms by iteration, or what went wrong
    std::string advice;       ///< where it has not converged: an entry that may help, as a sentence
    bool was_stopped = false; ///< by StaticProblem::must_stop
  };

  /** Finds the equilibrium of a static step: a plug-in, `Time integration`. */
  template <int dim>
  class StaticSolver
  {
  public:
    virtual ~StaticSolver() = default;

    /** Solves R(u) = 0 up to |R| <= @p tolerance times the force scale, from u = 0. The last
     * evaluation of the problem is that of the solution, where there is one. The same on all ranks.
     * Collective. */
    virtual StaticSolution solve(StaticProblem<dim> &problem, double tolerance) = 0;

    /** Whether so many iterations are few, so that the next step may be longer. */
    virtual bool was_easy(const StaticSolution &solution) const = 0;

    /** Evaluations of the forces of all cells that it has made beside those of the problem: a
     * matrix takes as many as a cell has components. */
    virtual double further_evaluations() const
    {
      return 0.;
    }

    /** Adds what it cost so far. */
    virtual void add_to_summary(Json & /*summary*/) const {}
  };

  template <int dim>
  struct PluginKind<StaticSolver<dim>>
  {
    static constexpr const char *name = "static solver";
  };
} // namespace tombolo
