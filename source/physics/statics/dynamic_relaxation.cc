// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/dynamic_relaxation.h>

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/ordered_sum.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** With which a step of one is stable: at least a quarter of the row sum. */
    double relaxation_mass(const double row_sum)
    {
      return 0.3 * row_sum;
    }
  } // namespace

  template <int dim>
  DynamicRelaxation<dim>::DynamicRelaxation(const Entries &e)
      : max_iterations(e.integer("Max iterations", "200000", at_least(1),
                                 "A step that needs more evaluations of the forces is halved."))
  {}

  template <int dim>
  double DynamicRelaxation<dim>::advance(const StaticProblem<dim> &problem,
                                         const double prescribed_share, const bool is_from_rest)
  {
    // The first step from rest is half a one: a whole one, again and again, would not be stable.
    const double step = is_from_rest ? 0.5 : 1.;
    double energy = 0;
    displacement.fill(
        [&](const unsigned int i, double *const of_node)
        {
          for (unsigned int d = 0; d < dim; ++d)
          {
            if (problem.constrained().node(i)[d] > 0.)
            {
              of_node[d] = prescribed_share * problem.prescribed().node(i)[d];
              continue;
            }
            const double mass = relaxation_mass(matrix->row_sums().node(i)[d]);
            if (!(mass > 0.))
              continue;
            double &speed = velocity.node(i)[d];
            speed += step * problem.residual().node(i)[d] / mass;
            of_node[d] += speed;
            energy += 0.5 * mass * speed * speed;
          }
        });
    return ordered_sum(energy, problem.model.communicator);
  }

  template <int dim>
  void DynamicRelaxation<dim>::go_to_rest(const StaticProblem<dim> &problem)
  {
    displacement.fill(
        [&](const unsigned int i, double *const of_node)
        {
          for (unsigned int d = 0; d < dim; ++d)
          {
            const double mass = relaxation_mass(matrix->row_sums().node(i)[d]);
            if (problem.constrained().node(i)[d] > 0. || !(mass > 0.))
              continue;
            const double now = velocity.node(i)[d];
            const double before = now - problem.residual().node(i)[d] / mass;
            of_node[d] -= now + 0.5 * before;
          }
        });
    velocity.set_zero();
  }

  template <int dim>
  StaticSolution DynamicRelaxation<dim>::solve(StaticProblem<dim> &problem, const double tolerance)
  {
    // What is prescribed is brought on over so many steps, and masses follow the stiffness.
    // The scale of forces is known once loads have reached all cells.
    constexpr unsigned int ramp = 200, mass_interval = 2000, settling_time = 100,
                           stop_interval = 100;
    const auto &partition = problem.model.state.partition();
    if (matrix == nullptr)
    {
      matrix = std::make_unique<TangentMatrix<dim>>(problem, TangentMatrix<dim>::Solver::direct);
      displacement.reinit(partition);
      velocity.reinit(partition);
      cells_per_matrix = dim * std::pow(problem.model.degree + 1., dim) + 1.;
    }
    displacement.set_zero();
    velocity.set_zero();
    StaticSolution result;
    const bool is_driven = problem.is_driven();
    const unsigned int ramp_end = is_driven ? ramp : 0;
    double last_energy = 0;
    bool is_from_rest = true;
    for (result.n_iterations = 0;; ++result.n_iterations)
    {
      if (!problem.evaluate(displacement))
      {
        result.report = problem.failure();
        return result;
      }
      const unsigned int k = result.n_iterations;
      if (k == 0 || k == ramp_end || k == ramp_end + settling_time ||
          (k > ramp_end && (k - ramp_end) % mass_interval == 0))
      {
        matrix->assemble();
        if (!problem.evaluate(displacement))
          return result;
      }
      const double norm = problem.residual_norm();
      result.residual = problem.relative(norm, tolerance);
      result.has_converged = k >= ramp_end && result.residual <= tolerance;
      result.was_stopped = !result.has_converged && k % stop_interval == stop_interval - 1 &&
                           problem.must_stop && problem.must_stop();
      if (result.has_converged || result.was_stopped || k >= max_iterations || !std::isfinite(norm))
        break;
      const double share = is_driven ? std::min(1., (k + 1.) / ramp) : 0.;
      const double energy = advance(problem, share, is_from_rest);
      is_from_rest = false;
      ++iterations;
      if (energy < last_energy && k >= ramp_end)
      {
        go_to_rest(problem);
        is_from_rest = true;
        ++n_restarts;
        last_energy = 0;
      }
      else
        last_energy = energy;
    }
    result.report = format_number(result.residual) + " after " +
                    std::to_string(result.n_iterations) + " iterations";
    if (!result.has_converged && result.n_iterations >= max_iterations)
      result.advice = "A larger `Max iterations` (section Statics/dynamic relaxation) may help.";
    return result;
  }

  template <int dim>
  bool DynamicRelaxation<dim>::was_easy(const StaticSolution &) const
  {
    return true;
  }

  template <int dim>
  double DynamicRelaxation<dim>::further_evaluations() const
  {
    return matrix == nullptr ? 0. : cells_per_matrix * double(matrix->n_assemblies());
  }

  template <int dim>
  void DynamicRelaxation<dim>::add_to_summary(Json &summary) const
  {
    summary["relaxation_iterations"] = iterations;
    summary["kinetic_restarts"] = n_restarts;
  }

  template class DynamicRelaxation<2>;
  template class DynamicRelaxation<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StaticSolver, DynamicRelaxation, "dynamic relaxation",
                                  "explicit steps with kinetic damping and masses that bring every "
                                  "node to one step, until the residual is small")
} // namespace tombolo
