// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/physics/statics/static_problem.h>
#include <tombolo/physics/statics/tangent_matrix.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Bodies that are pressed together lift off from each other node by node. */
    constexpr unsigned int most_with_other_contacts = 5;

    /** Advice where there are too many of these residuals, by iteration. */
    std::string advice_on_iterations(const std::vector<double> &residuals, const double tolerance)
    {
      constexpr std::size_t most = 6;
      constexpr double slow = 0.97;
      const std::size_t n = std::min(most, residuals.size() - 1);
      const double rate = std::pow(residuals.back() / residuals[residuals.size() - 1 - n],
                                   1. / static_cast<double>(n));
      if (!(rate < slow))
        return "The residual does not fall any more: more iterations do not help; where bodies "
               "touch, a smaller `Contact stiffness` (section Statics) may.";
      const double more = std::ceil(std::log(tolerance / residuals.back()) / std::log(rate));
      return "At the rate of the last " + std::to_string(n) + " iterations some " +
             format_number(static_cast<double>(residuals.size() - 1) + more) +
             " are needed: a larger `Max iterations` (section Statics/quasi-static) helps.";
    }
  } // namespace

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
    explicit NewtonKrylov(const Entries &e)
    {
      const bool is_direct =
          e.choice("Linear solver", "multigrid", "multigrid|direct",
                   "How the linear equations of an iteration are solved: `multigrid` (GMRES with "
                   "smoothed aggregation that knows rigid modes), or `direct` (a sparse "
                   "factorization, for small bodies and thin ones).") == "direct";
      solver =
          is_direct ? TangentMatrix<dim>::Solver::direct : TangentMatrix<dim>::Solver::multigrid;
      max_iterations =
          e.integer("Max iterations", "20", at_least(1),
                    "A step that needs more iterations of Newton's method is halved. Those "
                    "that find other nodes in contact do not count, up to four times "
                    "as many.");
    }

    StaticSolution solve(StaticProblem<dim> &problem, const double tolerance) override
    {
      const auto &partition = problem.model.state.partition();
      if (matrix == nullptr)
      {
        matrix = std::make_unique<TangentMatrix<dim>>(problem, solver);
        for (NodalVector *const vector : {&displacement, &change, &trial, &next})
          vector->reinit(partition);
      }
      // So that a resumed step is the same as one without interruption.
      matrix->use(solver);
      displacement.set_zero();
      StaticSolution result;
      const auto fail = [&](const std::string &why)
      {
        result.report += (result.report.empty() ? "" : ", ") + why;
        return result;
      };
      if (!problem.evaluate(displacement))
        return fail(problem.failure());
      double norm = problem.residual_norm();
      bool is_driven = problem.is_driven();
      double best = norm;
      unsigned int n_counted = 0;
      std::vector<double> residuals;
      for (result.n_iterations = 0;; ++result.n_iterations)
      {
        result.residual = problem.relative(norm, tolerance);
        residuals.push_back(result.residual);
        result.report += (result.report.empty() ? "" : ", ") + format_number(result.residual);
        result.has_converged = !is_driven && result.residual <= tolerance;
        if (result.has_converged)
          return result;
        n_counted += result.n_iterations > 0 && !matrix->contacts_changed() ? 1 : 0;
        if (n_counted == max_iterations ||
            result.n_iterations == most_with_other_contacts * max_iterations)
        {
          result.advice = advice_on_iterations(residuals, tolerance);
          return fail("no convergence within " + std::to_string(result.n_iterations) +
                      " iterations");
        }
        // The residual is largest at the start of a driven step; later it must shrink.
        if (result.n_iterations > 4 && norm > 1e4 * best)
          return fail("the residual grows");
        result.was_stopped = problem.must_stop && problem.must_stop();
        if (result.was_stopped)
          return fail("stopped");
        matrix->assemble();
        const std::string failure =
            solve_linear(problem, is_driven, 0.01 * tolerance * problem.scale(tolerance), result);
        if (!failure.empty())
          return fail(failure);
        ++newton_iterations;
        if (is_driven)
        {
          displacement.copy_from(change);
          if (!problem.evaluate(displacement))
            return fail(problem.failure());
          norm = best = problem.residual_norm();
          is_driven = false;
          continue;
        }
        norm = search_line(problem, norm, change, displacement);
        if (!std::isfinite(norm))
          return fail(problem.failure());
        best = std::min(best, norm);
      }
    }

    bool was_easy(const StaticSolution &solution) const override
    {
      return solution.n_iterations <= 6;
    }

    double further_evaluations() const override
    {
      return matrix == nullptr ? 0. : matrix->evaluations();
    }

    void add_to_summary(Json &summary) const override
    {
      summary["newton_iterations"] = newton_iterations;
      summary["linear_iterations"] = linear_iterations;
      summary["matrices"] = matrix == nullptr ? 0 : matrix->n_assemblies();
    }

  private:
    /** Adds the step @p change to @p displacement, or the part of it that makes |R| smaller, or its
     * power along the step, or the step that would follow by the same matrix. Returns the new |R|;
     * infinite where there is none. Collective. */
    double search_line(StaticProblem<dim> &problem, const double norm, const NodalVector &change,
                       NodalVector &displacement)
    {
      constexpr unsigned int most_halvings = 6;
      constexpr double sufficient = 1e-4, accuracy_of_next = 1e-2, halved = 0.5;
      const auto n = std::size_t(displacement.partition()->n_local()) * node_stride;
      const double size = std::sqrt(change.dot(change)), power = problem.residual().dot(change);
      const auto evaluate_at = [&](const double part)
      {
        for (std::size_t i = 0; i < n; ++i)
          trial.data()[i] = displacement.data()[i] + part * change.data()[i];
        return problem.evaluate(trial) ? problem.residual_norm()
                                       : std::numeric_limits<double>::infinity();
      };
      // Where the volume is kept, |R| grows in a full step, and its power along the step falls, or
      // the next step by the same matrix is short.
      const auto makes_progress = [&](const double part, const double now)
      {
        if (std::isfinite(now) &&
            std::abs(problem.residual().dot(change)) <= halved * std::abs(power))
          return true;
        if (!std::isfinite(now) ||
            matrix->solve(problem.residual(), nullptr, accuracy_of_next * now, next) < 0)
          return false;
        return std::sqrt(next.dot(next)) <= (1. - halved * part) * size;
      };
      double factor = 1., best = std::numeric_limits<double>::infinity(), best_factor = 0.;
      for (unsigned int k = 0; k <= most_halvings; ++k, factor *= 0.5)
      {
        const double now = evaluate_at(factor);
        if (now < (1. - sufficient * factor) * norm || makes_progress(factor, now))
        {
          displacement.copy_from(trial);
          return now;
        }
        if (now < best)
        {
          best = now;
          best_factor = factor;
        }
      }
      if (best_factor == 0.)
        return best;
      best = evaluate_at(best_factor);
      displacement.copy_from(trial);
      return best;
    }

    /** Finds @p change; where multigrid fails, by a factorization if the matrix is small enough for
     * it. Returns the failure; empty: none. Collective. */
    std::string solve_linear(StaticProblem<dim> &problem, const bool is_driven, const double target,
                             StaticSolution &solution)
    {
      using Solver = typename TangentMatrix<dim>::Solver;
      const auto try_it = [&]
      {
        return matrix->solve(problem.residual(), is_driven ? &problem.prescribed() : nullptr,
                             target, change);
      };
      int n_linear = try_it();
      const bool multigrid_failed = n_linear < 0 && matrix->present_solver() == Solver::multigrid;
      const std::string advice = "multigrid did not solve the linear equations within " +
                                 std::to_string(TangentMatrix<dim>::most_iterations) +
                                 " iterations, as where a body hardly changes its volume (`Linear "
                                 "solver = direct` in section Statics/quasi-static ";
      if (multigrid_failed && matrix->is_fit_for_direct())
      {
        linear_iterations += TangentMatrix<dim>::most_iterations;
        solution.report += ", " + advice + "saves the attempt): direct for the rest of the step";
        matrix->use(Solver::direct);
        n_linear = try_it();
      }
      else if (multigrid_failed)
        return advice + "can solve them, with much memory for a body of this size)";
      if (n_linear < 0)
        return "the linear equations were not solved: their matrix is singular or not finite";
      linear_iterations += static_cast<unsigned long>(n_linear);
      return {};
    }

    typename TangentMatrix<dim>::Solver solver;
    unsigned int max_iterations;
    std::unique_ptr<TangentMatrix<dim>> matrix; ///< with the first step
    NodalVector displacement, change, trial, next;
    unsigned long linear_iterations = 0, newton_iterations = 0;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StaticSolver, NewtonKrylov, "quasi-static",
                                  "Newton's method with the consistent tangent of the materials, "
                                  "multigrid for its equations")
} // namespace tombolo
