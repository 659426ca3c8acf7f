// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/output/summary.h>
#include <tombolo/physics/heat/conduction_matrix.h>
#include <tombolo/physics/heat/thermal_step.h>

#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

namespace tombolo
{
  namespace
  {
    using Vector = LinearAlgebra::distributed::Vector<double>;
  } // namespace

  /**
   * Implicit steps of the heat equation, H(θ̂) - H_n = Δt [w r(θ̂) + (1 - w) r_n] with the heat rate
   * r = ThermalModel::heat_rate(): w = 1 is backward Euler, w = ½ Crank-Nicolson. Newton's method;
   * its linear systems, (dH/dθ + w Δt Sᵀ K S) δ = -residual, symmetric and positive definite, are
   * solved matrix-free by conjugate gradients.
   *
   * The preconditioner is B P Bᵀ. P is Trilinos' algebraic multigrid for the assembled matrix
   * D' + w Δt K of assemble_conduction_matrix(). Nodal gradients do not resist waves between
   * neighbouring particles, so that K has 2^dim near null vectors, the constants on sublattices();
   * which the multigrid receives. B = I + T with T = I - ΦS compensates S, which removes short
   * waves from the temperature before conduction: SᵀKS is small there. D' is the capacity with four
   * times its value at waves that T passes, so that B P Bᵀ is right where the capacity rules.
   *
   * The enthalpy follows from the rate at the solution, so that the enthalpy gains the heat that
   * enters, to round-off, at any tolerance.
   */
  template <int dim>
  class ImplicitHeat : public HeatIntegrator<dim>
  {
  public:
    /** @p weight is w. */
    ImplicitHeat(const Entries &e, const double weight) : weight(weight)
    {
      time_step =
          e.number("Step", mandatory, positive(), "T",
                   "The time step; steps are equal and at most so long that outputs are met.");
      tolerance =
          e.number("Tolerance", "1e-8", between(1e-15, 1e-2), "",
                   "The residual of a step over that of its beginning. The heat balance does "
                   "not depend on it: what enters is what the enthalpy gains, to round-off.");
      max_newton_iterations = e.integer("Max Newton iterations", "30", between(1, 10000),
                                        "A step that needs more stops the run.");
    }

    double allowed_step(const Model<dim> &, const double) override
    {
      return time_step;
    }

    void advance(const Model<dim> &model, const double time, const double step,
                 std::vector<double> &condition_heats) override
    {
      ThermalState &state = model.heat->state;
      set_partition(state.enthalpy.partition());
      StepEquation equation(*this, model, time, step, condition_heats.size());
      const double first_norm = equation.find_residual();
      double norm = first_norm;
      if (last_step > 0.)
      {
        // As it changed in the last step it will change in this one, or else not at all.
        norm = equation.extrapolate(step / last_step);
        if (!(norm < first_norm))
          norm = equation.extrapolate(0.);
      }
      last_temperature.copy_from(state.unsmoothed_temperature);
      last_step = step;

      solve_by_newton(equation, first_norm, norm);
      equation.add_heats(condition_heats);
      model.heat->find_temperature(equation.end, state.next_enthalpy, equation.theta,
                                   condition_heats);
    }

    const StepLimit &limit() const override
    {
      return no_limit;
    }

    void list(Records &records, const Model<dim> &model) override
    {
      Records &all = records.group("implicit heat");
      all.list(
          [this, &model](Records &now)
          {
            // A resumed run has the same bits only if the writing run renews the preconditioner,
            // too.
            preconditioner.reset();
            // The partition may have changed since the last thermal step.
            set_partition(model.state.partition());
            now.value("linear iterations", linear_iterations);
            now.value("Newton iterations", newton_iterations);
            now.value("last step", last_step);
          });
      all.list(
          [this](Records &now)
          {
            if (last_step > 0.)
              now.nodal("last temperature", 1, last_temperature);
          });
    }

    void mesh_has_changed() override
    {
      preconditioner.reset();
      last_step = 0.;
    }

    void add_to_summary(Summary &summary) const override
    {
      summary["heat_linear_iterations"] = linear_iterations;
      summary["heat_newton_iterations"] = newton_iterations;
    }

  private:
    class Preconditioner;
    class StepEquation;

    /** Renews vectors and preconditioner where the partition has changed. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      if (field.partition() == partition)
        return;
      for (NodalVector *vector : {&field, &direction, &image})
        vector->reinit(partition, Quantity::scalars);
      for (NodalVector *vector : {&rate, &first_rate, &capacity})
        vector->reinit(partition, Quantity::scalar);
      last_temperature.reinit(partition, Quantity::scalars);
      last_step = 0.;
      preconditioner.reset();
    }

    /** Solves for the Newton step until the residual is at most @p target. Returns the number of
     * iterations. */
    unsigned int solve(const Model<dim> &model, const double time, const double factor,
                       const double target, const Vector &right_hand_side, Vector &solution)
    {
      if (preconditioner == nullptr || std::abs(preconditioner->factor / factor - 1.) > 0.1)
      {
        preconditioner = std::make_unique<Preconditioner>(*this, model, time, factor);
        iterations_when_built = 0;
      }
      struct Operator
      {
        std::function<void(Vector &, const Vector &)> vmult;
      };
      const Operator matrix{
          [&](Vector &result, const Vector &source) // dH/dθ + w Δt Sᵀ K S
          {
            direction.fill([&](const unsigned int i, double *const value)
                           { *value = source.local_element(i); });
            model.heat->apply_conduction(model.state.position, field, time, direction, image);
            for (unsigned int i = 0; i < source.locally_owned_size(); ++i)
              result.local_element(i) =
                  *capacity.node(i) * source.local_element(i) + factor * *image.node(i);
          }};
      SolverControl control(2000, target);
      SolverCG<Vector> solver(control);
      solution = 0.;
      try
      {
        solver.solve(matrix, solution, right_hand_side, *preconditioner);
      }
      catch (const SolverControl::NoConvergence &)
      {
        throw RunError(as_text("The implicit heat step at time ", time, " did not converge within ",
                               control.last_step(),
                               " iterations of conjugate gradients. A smaller step, or a ",
                               "larger `Tolerance`, may help."));
      }
      // Temperatures or positions have changed so much that a new one is worth its cost.
      if (iterations_when_built == 0)
        iterations_when_built = control.last_step() + 1;
      else if (control.last_step() > 2 * iterations_when_built + 10)
        preconditioner.reset();
      return control.last_step();
    }

    /** Solves the equation of a step, whose residual has the norm @p norm, until this is at most
     * the tolerance times @p first_norm. */
    void solve_by_newton(StepEquation &equation, const double first_norm, double norm)
    {
      ThermalModel<dim> &heat = *equation.model.heat;
      const unsigned int n_owned = equation.n_owned;
      Vector correction(equation.residual);
      double capacity_norm = 0, last_norm = norm;
      for (unsigned int iteration = 0; norm > tolerance * first_norm; ++iteration)
      {
        // A linear problem is solved at once, as far as the tolerance of its solver goes; and of a
        // balance of large heats only round-off is left.
        if (iteration > 0 &&
            (heat.is_linear() || (norm > 0.5 * last_norm && norm < 1e-10 * capacity_norm)))
          break;
        if (iteration == max_newton_iterations || !std::isfinite(norm))
        {
          throw RunError(as_text("The implicit heat step from time ", equation.begin, " to ",
                                 equation.end, " did not converge within ", iteration,
                                 " iterations of Newton's method: its residual is still ",
                                 norm / first_norm, " of the first. A smaller `Step` may help."));
        }
        for (unsigned int i = 0; i < n_owned; ++i)
        {
          *capacity.node(i) = heat.nodal_enthalpy.capacity(i, *equation.theta.node(i));
          if (*capacity.node(i) == 0.) // all its cells were removed; its temperature stays
            *capacity.node(i) = 1.;
          correction.local_element(i) = *capacity.node(i) * *equation.theta.node(i);
        }
        capacity_norm = correction.l2_norm();
        const double target =
            std::max(0.3 * tolerance * first_norm, heat.is_linear() ? 0. : 1e-3 * norm);
        linear_iterations += solve(equation.model, equation.end, weight * equation.step, target,
                                   equation.residual, correction);
        ++newton_iterations;
        for (unsigned int i = 0; i < n_owned; ++i)
          *equation.theta.node(i) += correction.local_element(i);
        last_norm = norm;
        norm = equation.find_residual();
      }
    }

    double weight;
    double time_step;
    double tolerance;
    unsigned int max_newton_iterations;
    StepLimit no_limit;
    std::unique_ptr<Preconditioner> preconditioner;
    unsigned int iterations_when_built = 0;
    unsigned long linear_iterations = 0, newton_iterations = 0;

    NodalVector last_temperature; ///< θ̂ at the beginning of the last step, for the first guess
    double last_step = 0;         ///< 0: none

    NodalVector field, rate, first_rate, capacity, direction, image;
  };

  /** w = 1. */
  template <int dim>
  class BackwardEulerHeat : public ImplicitHeat<dim>
  {
  public:
    explicit BackwardEulerHeat(const Entries &e) : ImplicitHeat<dim>(e, 1.) {}
  };

  /** w = ½. */
  template <int dim>
  class CrankNicolsonHeat : public ImplicitHeat<dim>
  {
  public:
    explicit CrankNicolsonHeat(const Entries &e) : ImplicitHeat<dim>(e, 0.5) {}
  };

  template <int dim>
  class ImplicitHeat<dim>::Preconditioner
  {
  public:
    Preconditioner(ImplicitHeat &owner, const Model<dim> &model, const double time,
                   const double factor)
        : factor(factor), owner(owner), model(model)
    {
      NodalVector diagonal(owner.capacity.partition(), Quantity::scalar);
      model.heat->add_film_diagonal(time, owner.field, diagonal);
      for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
        *diagonal.node(i) = *owner.capacity.node(i) + factor * *diagonal.node(i);
      is_diagonal = true;
      for (const Part<dim> &part : model.parts)
        is_diagonal = is_diagonal && part.heat->conductivity().largest() == 0.;
      inverse_diagonal.reinit(owner.capacity.partition(), Quantity::scalar);
      for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
        *inverse_diagonal.node(i) = 1. / *diagonal.node(i);
      if (is_diagonal)
        return;
      const Bridge &bridge = model.heat->bridge;
      inverts_smoothing = bridge.has_particles() && bridge.smoothing().is_active;
      between.reinit(owner.capacity.partition()->owned(),
                     owner.capacity.partition()->communicator());
      constexpr double at_short_waves = (1. + short_wave_weight) * (1. + short_wave_weight);
      assemble_conduction_matrix(model, owner.field, factor,
                                 inverts_smoothing ? at_short_waves - 1. : 0., diagonal, matrix);
      TrilinosWrappers::PreconditionAMG::AdditionalData data;
      data.elliptic = true;
      data.smoother_sweeps = 2;
      data.aggregation_threshold = 0.02;
      if (bridge.has_particles())
        data.constant_modes = sublattices(model);
      multigrid.initialize(matrix, data);
    }

    void vmult(Vector &result, const Vector &source) const
    {
      const unsigned int n_owned = source.locally_owned_size();
      if (is_diagonal)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          result.local_element(i) = *inverse_diagonal.node(i) * source.local_element(i);
        return;
      }
      if (!inverts_smoothing)
      {
        multigrid.vmult(result, source);
        return;
      }
      const NodalVector &capacity = model.heat->bridge.lumped_mass();
      for (unsigned int i = 0; i < n_owned; ++i)
        *owner.direction.node(i) =
            source.local_element(i) / (*capacity.node(i) > 0. ? *capacity.node(i) : 1.);
      add_short_waves();
      for (unsigned int i = 0; i < n_owned; ++i)
        between.local_element(i) = *capacity.node(i) * *owner.image.node(i);
      multigrid.vmult(result, between);
      for (unsigned int i = 0; i < n_owned; ++i)
        *owner.direction.node(i) = result.local_element(i);
      add_short_waves();
      for (unsigned int i = 0; i < n_owned; ++i)
        result.local_element(i) = *owner.image.node(i);
    }

    const double factor; ///< w Δt that it was made for

  private:
    static constexpr double short_wave_weight = 1.; // c

    /** image = (I + c T) direction of owned nodes, zero where the temperature is prescribed. */
    void add_short_waves() const
    {
      const std::vector<unsigned int> &constrained = model.heat->conditions.constrained_nodes();
      owner.direction.fill(constrained,
                           [](const std::size_t, double *const value) { *value = 0.; });
      model.heat->bridge.apply_short_wave_part(owner.direction, owner.image);
      for (unsigned int i = 0; i < between.locally_owned_size(); ++i)
        *owner.image.node(i) = *owner.direction.node(i) + short_wave_weight * *owner.image.node(i);
      for (const unsigned int node : constrained)
        *owner.image.node(node) = 0.;
    }

    ImplicitHeat &owner;
    const Model<dim> &model;
    mutable Vector between;
    bool inverts_smoothing = false;
    bool is_diagonal = false;
    NodalVector inverse_diagonal;
    TrilinosWrappers::SparseMatrix matrix;
    TrilinosWrappers::PreconditionAMG multigrid;
  };

  /** The equation of one step, H(θ̂) - H_n = Δt [w r(θ̂) + (1 - w) r_n]. It starts from the present
   * temperature, but for prescribed ones. */
  template <int dim>
  class ImplicitHeat<dim>::StepEquation
  {
  public:
    StepEquation(ImplicitHeat &owner, const Model<dim> &model, const double time, const double step,
                 const std::size_t n_conditions)
        : model(model), theta(model.heat->state.next_unsmoothed_temperature), begin(time),
          end(time + step), step(step), n_owned(model.heat->state.enthalpy.partition()->n_owned()),
          owner(owner), heat(*model.heat), state(heat.state), first_rates(n_conditions, 0.)
    {
      owner.first_rate.set_zero();
      if (owner.weight < 1.)
      {
        heat.find_field(state.unsmoothed_temperature, owner.field);
        heat.heat_rate(model.state.position, owner.field, time, owner.first_rate, first_rates);
      }
      const NodePartition &partition = *state.enthalpy.partition();
      residual.reinit(partition.owned(), partition.communicator());
      theta.copy_from(state.unsmoothed_temperature);
      heat.conditions.prescribe(model.state.initial_position, end, theta);
    }

    /** Sets the next enthalpy by the rates at θ̂, and the residual; returns its norm. */
    double find_residual()
    {
      const double weight = owner.weight;
      rates.assign(first_rates.size(), 0.);
      heat.find_field(theta, owner.field);
      heat.heat_rate(model.state.position, owner.field, end, owner.rate, rates);
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        *state.next_enthalpy.node(i) =
            *state.enthalpy.node(i) +
            step * (weight * *owner.rate.node(i) + (1. - weight) * *owner.first_rate.node(i));
        residual.local_element(i) =
            *state.next_enthalpy.node(i) - heat.nodal_enthalpy.enthalpy(i, *theta.node(i));
      }
      for (const unsigned int node : heat.conditions.constrained_nodes())
        residual.local_element(node) = 0.;
      return residual.l2_norm();
    }

    /** Sets θ̂ to its value after @p ratio times the change of the last step; returns the norm of
     * the residual. */
    double extrapolate(const double ratio)
    {
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        const double now = *state.unsmoothed_temperature.node(i);
        *theta.node(i) = now + ratio * (now - *owner.last_temperature.node(i));
      }
      heat.conditions.prescribe(model.state.initial_position, end, theta);
      return find_residual();
    }

    /** Adds the heats of the step by condition, as of the last residual. */
    void add_heats(std::vector<double> &condition_heats) const
    {
      const double weight = owner.weight;
      for (std::size_t c = 0; c < rates.size(); ++c)
        condition_heats[c] += step * (weight * rates[c] + (1. - weight) * first_rates[c]);
    }

    const Model<dim> &model;
    NodalVector &theta; ///< θ̂, the next unsmoothed temperature
    const double begin, end, step;
    const unsigned int n_owned;
    Vector residual;

  private:
    ImplicitHeat &owner;
    ThermalModel<dim> &heat;
    ThermalState &state;
    std::vector<double> first_rates, rates; ///< by condition
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(HeatIntegrator, BackwardEulerHeat, "backward Euler",
                                  "implicit steps of first order, without oscillations")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(HeatIntegrator, CrankNicolsonHeat, "Crank-Nicolson",
                                  "implicit steps of second order")
} // namespace tombolo
