// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/physics/statics/static_problem.h>
#include <tombolo/state/dependent_nodes.h>

#include <deal.II/base/index_set.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/solver_control.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_solver.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The tangent of a StaticProblem, -∂R/∂u, assembled from the cells and the springs of processes,
   * and linear systems with it.
   * Component d of the node with global number I is row dim I + d. Prescribed components have
   * their diagonal alone; what they move goes to the right-hand side. Dependent nodes have their
   * diagonal alone, too: what they have goes to those on which they depend.
   *
   * `multigrid` is GMRES with Trilinos' smoothed aggregation (ML), whose near null space are the
   * rigid modes at the present positions; `direct` is a sparse LU factorization (Amesos). Both
   * give the same bits at each repetition on the same number of ranks: nothing in them is random.
   */
  template <int dim>
  class TangentMatrix
  {
  public:
    enum class Solver
    {
      multigrid,
      direct
    };

    static constexpr unsigned int most_iterations = 500; ///< of GMRES

    TangentMatrix(StaticProblem<dim> &problem, Solver solver);

    Solver present_solver() const
    {
      return solver;
    }

    /** The solver of the systems from here on. */
    void use(const Solver other)
    {
      solver = other;
    }

    /** Whether a factorization takes about the memory and time of a few hundred iterations. */
    bool is_fit_for_direct() const
    {
      return matrix.m() <= (dim == 2 ? 100000 : 15000);
    }

    /** Assembles at the displacement last evaluated; afterwards StaticProblem::evaluate() must be
     * called before anything is read of it. Raises its force scale. Collective. */
    void assemble();

    /**
     * Solves K du = R for the components that are free and with @p prescribed at the others, of
     * which ghosts are current; null: zero. @p residual is R, owned values; @p change gets current
     * ghosts. What is left of the right-hand side has at most the norm @p target, or 1e-8 of it.
     * Returns the number of iterations; negative where they did not converge. The preconditioner or
     * factorization is kept for further systems until the next assemble(). Collective.
     */
    int solve(const NodalVector &residual, const NodalVector *prescribed, double target,
              NodalVector &change);

    /** Σ_j |K_ij| with a bound of that of springs, by component of owned nodes. */
    const NodalVector &row_sums() const
    {
      return absolute_row_sums;
    }

    /** Whether, at the last assembly, other nodes were in contact than at the one before. The same
     * on all ranks. */
    bool contacts_changed() const
    {
      return has_other_springs;
    }

    std::uint64_t n_assemblies() const
    {
      return count;
    }

    /** Evaluations of the forces of all cells that its assemblies were as long as. */
    double evaluations() const
    {
      return (dim * std::pow(problem.model.degree + 1., dim) + 1.) * double(count);
    }

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

    void make_pattern(const std::vector<ContactStiffness<dim>> &springs);
    void add_cell(const CellEquations &equations);
    void add_matrix(const std::vector<unsigned int> &local_nodes,
                    const std::vector<double> &entries);
    void add_spring(const ContactStiffness<dim> &stiffness);
    /** Adds dim rows and columns a node, by rows of @p entries. */
    void add_equations(const DependentRows::Nodes &nodes, const std::vector<double> &entries);
    /** Sets the scale of forces of the problem and what rounding does to them. Collective. */
    void find_scales();
    /** Asks other ranks which components of nodes of springs, and of those on which others depend,
     * are prescribed. Collective. */
    void find_far_constraints(const std::vector<ContactStiffness<dim>> &springs);
    bool is_constrained(dealii::types::global_dof_index node, unsigned int component) const;
    /** Rigid modes by mode and row, at present positions. Collective. */
    void find_rigid_modes();
    void prepare_multigrid();

    void forget_solvers()
    {
      multigrid.clear();
      has_multigrid = false;
      factorization.reset();
    }

    StaticProblem<dim> &problem;
    Solver solver;
    dealii::IndexSet owned_rows;
    DependentRows dependent;
    dealii::TrilinosWrappers::SparseMatrix matrix;   ///< with rows and columns of free components
    dealii::TrilinosWrappers::SparseMatrix coupling; ///< rows free, columns prescribed
    dealii::TrilinosWrappers::PreconditionAMG multigrid;
    dealii::SolverControl control_of_factorization; ///< which the factorization refers to
    std::unique_ptr<dealii::TrilinosWrappers::SolverDirect> factorization;
    bool has_multigrid = false;
    std::vector<double> rigid_modes;
    /** By node that is none of this rank, a bit for each component. */
    std::map<dealii::types::global_dof_index, unsigned int> far_constraints;
    bool has_springs = false; ///< in the pattern
    bool has_other_springs = false;
    std::vector<unsigned int> nodes_with_springs; ///< of this rank
    NodalVector cell_forces, absolute_row_sums;
    NodalVector spring_bound;   ///< of springs
    NodalVector rounded_forces; ///< Σ_j |K_ij x_j|, by how much forces change with rounding
    std::uint64_t count = 0;
  };
} // namespace tombolo
