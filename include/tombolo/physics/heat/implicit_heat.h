// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/physics/heat/heat_integrator.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <memory>

namespace tombolo
{
  /**
   * Implicit steps of the heat equation, H(θ̂) - H_n = Δt [w r(θ̂) + (1 - w) r_n] with the heat rate
   * r = ThermalModel::heat_rate(): w = 1 is backward Euler, w = ½ Crank-Nicolson. Newton's method;
   * its linear systems, (dH/dθ + w Δt Sᵀ K S) δ = -residual, symmetric and positive definite, are
   * solved matrix-free by conjugate gradients.
   *
   * The preconditioner is B P Bᵀ. P is Trilinos' algebraic multigrid for the assembled matrix
   * D' + w Δt K of assemble_conduction_matrix(). Nodal gradients do not resist waves between
   * neighbouring particles, so that K has 2^dim near null vectors, the constants on sublattices();
   * the multigrid is told of them. B = I + T with T = I - ΦS makes up for S, which takes short
   * waves out of the temperature before it conducts: SᵀKS is small there. D' is the capacity with
   * four times its value at waves that T passes, so that B P Bᵀ is right where the capacity rules.
   *
   * The enthalpy follows from the rate at the solution, so that what enters is what the enthalpy
   * gains, to round-off, whatever the tolerance.
   */
  template <int dim>
  class ImplicitHeat : public HeatIntegrator<dim>
  {
  public:
    /** @p weight is w. */
    ImplicitHeat(const Entries &e, double weight);
    ~ImplicitHeat() override;

    double allowed_step(Model<dim> &model, double time) override;
    void advance(Model<dim> &model, double time, double time_step,
                 std::vector<double> &of_condition) override;
    const StepLimit &limit() const override;
    void list(Records &records, const Model<dim> &model) override;
    void mesh_has_changed() override;
    void add_to_summary(Summary &summary) const override;

    /** Iterations of conjugate gradients and of Newton since the beginning. */
    unsigned long n_linear_iterations() const;
    unsigned long n_newton_iterations() const;

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    class Operator;
    class Preconditioner;
    class StepEquation;

    /** Makes what hangs on the partition anew where that has changed. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Solves for the Newton step until the residual is at most @p target. Returns the number of
     * iterations. */
    unsigned int solve(Model<dim> &model, double time, double factor, double target,
                       const Vector &right_hand_side, Vector &solution);

    /** Solves the equation of a step, whose residual has the norm @p norm, until this is at most
     * the tolerance times @p first_norm. */
    void solve_by_newton(StepEquation &equation, double first_norm, double norm);

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
} // namespace tombolo
