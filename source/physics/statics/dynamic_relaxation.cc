// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/physics/statics/static_problem.h>
#include <tombolo/physics/statics/tangent_matrix.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace tombolo
{
  namespace
  {
    /** A mass with which a step of one is stable: at least a quarter of the row sum. */
    double relaxation_mass(const double row_sum)
    {
      return 0.3 * row_sum;
    }
  } // namespace

  /**
   * Dynamic relaxation with kinetic damping: explicit steps of size one of a body with masses of
   * its own, m = Σ_j |K_ij| times 0.3 by row sums of the stiffness, with which every mode is stable
   * at that step (Gershgorin), from rest; velocities are set to zero at each maximum of the kinetic
   * energy, and positions to those at about that time, the middle between the last two before the
   * energy fell (Barnes, Int. J. Space Struct. 14, 89-104, 1999): without that, vibrations of three
   * steps would last. It solves the same equations as NewtonKrylov, each evaluation from the
   * material points at the start of the step, so that the path of the relaxation leaves no plastic
   * strain. The baseline: it needs no linear solver, but thousands of evaluations.
   */
  template <int dim>
  class DynamicRelaxation : public StaticSolver<dim>
  {
  public:
    explicit DynamicRelaxation(const Entries &e)
        : max_iterations(e.integer("Max iterations", "200000", at_least(1),
                                   "A step that needs more evaluations of the forces is halved."))
    {}

    StaticSolution solve(StaticProblem<dim> &problem, const double tolerance) override
    {
      // Prescribed motion is applied over so many steps, and masses follow the stiffness.
      // The scale of forces is computed once loads have reached all cells.
      constexpr unsigned int ramp = 200, mass_interval = 2000, settling_time = 100,
                             stop_interval = 100;
      const auto &partition = problem.model.state.partition();
      if (matrix == nullptr)
      {
        matrix = std::make_unique<TangentMatrix<dim>>(problem, TangentMatrix<dim>::Solver::direct);
        displacement.reinit(partition);
        velocity.reinit(partition);
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
        if (result.has_converged || result.was_stopped || k >= max_iterations ||
            !std::isfinite(norm))
          break;
        const double share = is_driven ? std::min(1., (k + 1.) / ramp) : 0.;
        const double energy = advance(problem, share, is_from_rest);
        is_from_rest = false;
        ++iterations;
        if (energy < last_energy && k >= ramp_end)
        {
          stop_motion(problem);
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

    bool was_easy(const StaticSolution &) const override
    {
      return true;
    }

    double further_evaluations() const override
    {
      return matrix == nullptr ? 0. : matrix->evaluations();
    }

    void add_to_summary(Json &summary) const override
    {
      summary["relaxation_iterations"] = iterations;
      summary["kinetic_restarts"] = n_restarts;
    }

  private:
    /** After a step that has lost kinetic energy. */
    void stop_motion(const StaticProblem<dim> &problem)
    {
      displacement.fill(
          [&](const unsigned int i, double *const node_displacement)
          {
            const std::array<double, 3> residual = along_frame(problem, i, problem.residual());
            problem.frames().turn(velocity.partition()->global_index(i), node_displacement);
            for (unsigned int d = 0; d < dim; ++d)
            {
              const double mass = mass_along(problem, i, d);
              if (problem.constrained().node(i)[d] > 0. || !(mass > 0.))
                continue;
              const double now = velocity.node(i)[d];
              const double before = now - residual[d] / mass;
              node_displacement[d] -= now + 0.5 * before;
            }
            problem.frames().turn_back(velocity.partition()->global_index(i), node_displacement);
          });
      velocity.set_zero();
    }

    /** One step of the relaxation: displacement and velocity by the residual. Returns the kinetic
     * energy. Collective. */
    double advance(const StaticProblem<dim> &problem, const double prescribed_share,
                   const bool is_from_rest)
    {
      // The first step from rest is half a one: a whole one, again and again, would not be stable.
      const double step = is_from_rest ? 0.5 : 1.;
      double energy = 0;
      displacement.fill(
          [&](const unsigned int i, double *const node_displacement)
          {
            const std::array<double, 3> residual = along_frame(problem, i, problem.residual()),
                                        prescribed = along_frame(problem, i, problem.prescribed());
            problem.frames().turn(velocity.partition()->global_index(i), node_displacement);
            for (unsigned int d = 0; d < dim; ++d)
            {
              if (problem.constrained().node(i)[d] > 0.)
              {
                node_displacement[d] = prescribed_share * prescribed[d];
                continue;
              }
              const double mass = mass_along(problem, i, d);
              if (!(mass > 0.))
                continue;
              double &speed = velocity.node(i)[d];
              speed += step * residual[d] / mass;
              node_displacement[d] += speed;
              energy += 0.5 * mass * speed * speed;
            }
            problem.frames().turn_back(velocity.partition()->global_index(i), node_displacement);
          });
      return ordered_sum(energy, problem.model.communicator);
    }

    /** A vector of an owned node along its frame. */
    static std::array<double, 3> along_frame(const StaticProblem<dim> &problem,
                                             const unsigned int node, const NodalVector &vector)
    {
      std::array<double, 3> result{};
      std::copy_n(vector.node(node), dim, result.begin());
      problem.frames().turn(vector.partition()->global_index(node), result.data());
      return result;
    }

    /** Row sums along other axes are at most dim times the largest of those along the coordinates.
     */
    double mass_along(const StaticProblem<dim> &problem, const unsigned int node,
                      const unsigned int d) const
    {
      const double *const sums = matrix->row_sums().node(node);
      const bool is_turned =
          problem.frames().find(velocity.partition()->global_index(node)) != nullptr;
      return relaxation_mass(is_turned ? dim * *std::max_element(sums, sums + dim) : sums[d]);
    }

    unsigned int max_iterations;
    std::unique_ptr<TangentMatrix<dim>> matrix; ///< for the masses
    NodalVector displacement;
    NodalVector velocity; ///< along the frames of nodes
    unsigned long iterations = 0, n_restarts = 0;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StaticSolver, DynamicRelaxation, "dynamic relaxation",
                                  "explicit steps with kinetic damping and masses that bring every "
                                  "node to one step, until the residual is small")
} // namespace tombolo
