// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/physics/statics/rigid_modes.h>
#include <tombolo/physics/statics/static_problem.h>
#include <tombolo/state/dependent_nodes.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/solver_control.h>
#include <deal.II/lac/solver_gmres.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_solver.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <Amesos.h>
#include <Epetra_MultiVector.h>
#include <Teuchos_ParameterList.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The tangent of a StaticProblem, -∂R/∂u, assembled from the cells and the springs of processes,
   * and linear systems with it.
   * Component d of the node with global number I is row dim I + d. Prescribed components have their
   * diagonal alone; their effect is on the right-hand side. Dependent nodes have their diagonal
   * alone, too: their entries are added to the nodes on which they depend.
   *
   * `multigrid` is GMRES with Trilinos' smoothed aggregation (ML), whose near null space are the
   * rigid modes at the present positions; `direct` is a sparse LU factorization (Amesos). Both have
   * the same bits at each repetition on the same number of ranks: nothing in them is random.
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

    TangentMatrix(StaticProblem<dim> &problem, const Solver solver)
        : problem(problem), solver(solver),
          owned_rows(rows_of(problem.model.state.partition()->owned()))
    {
      for (NodalVector *const vector :
           {&cell_forces, &absolute_row_sums, &rounded_forces, &spring_bound})
        vector->reinit(problem.model.state.partition(), Quantity::scalars);
      NodalVector none(problem.model.state.partition(), Quantity::scalar);
      dependent = DependentRows(none);
      find_far_constraints({});
      make_pattern({});
    }

    Solver present_solver() const
    {
      return solver;
    }

    /** The solver of the systems from here on. */
    void use(const Solver other)
    {
      solver = other;
    }

    /** Whether a factorization needs about the memory and time of a few hundred iterations. */
    bool is_fit_for_direct() const
    {
      return matrix.m() <= (dim == 2 ? 100000 : 15000);
    }

    /** Assembles at the displacement last evaluated; afterwards StaticProblem::evaluate() must be
     * called before anything is read of it. Raises its force scale. Collective. */
    void assemble()
    {
      ++count;
      clear_solvers();
      std::vector<ContactStiffness<dim>> springs;
      spring_bound.set_zero();
      problem.linearize_processes(springs, spring_bound);
      spring_bound.condense();
      const bool had_springs = has_springs;
      std::vector<unsigned int> nodes_before(springs.size());
      std::transform(springs.begin(), springs.end(), nodes_before.begin(),
                     [](const ContactStiffness<dim> &spring) { return spring.node; });
      nodes_before.swap(nodes_with_springs);
      std::vector<int> flags{springs.empty() ? 0 : 1, nodes_before != nodes_with_springs ? 1 : 0};
      Utilities::MPI::max(flags, problem.model.communicator, flags);
      has_springs = flags[0] == 1;
      has_other_springs = flags[1] == 1;
      if (has_springs || had_springs)
      {
        find_far_constraints(springs);
        make_pattern(springs);
      }
      matrix = 0.;
      coupling = 0.;
      for (NodalVector *const sums : {&cell_forces, &absolute_row_sums, &rounded_forces})
        sums->set_zero();
      problem.restart_points();
      for (const Part<dim> &part : problem.model.parts)
        part.formulation->find_cell_equations(
            problem.input(), [this](const CellEquations &equations) { add_cell(equations); });
      for (const ContactStiffness<dim> &stiffness : springs)
        add_spring(stiffness);
      for (const unsigned int node : problem.model.state.partition()->dependent_nodes().node)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const types::global_dof_index row =
              problem.model.state.partition()->global_index(node) * dim + d;
          matrix.add(row, row, 1.);
        }
      matrix.compress(VectorOperation::add);
      coupling.compress(VectorOperation::add);
      for (NodalVector *const sums : {&cell_forces, &absolute_row_sums, &rounded_forces})
        sums->collect();
      find_scales();
    }

    /**
     * Solves K du = R for the components that are free and with @p prescribed at the others, of
     * which ghosts are current; null: zero. @p residual is R, owned values; @p change has current
     * ghosts. The residual of the system has at most the norm @p target, or 1e-8 of the right-hand
     * side. Returns the number of iterations; negative where they did not converge. The
     * preconditioner or factorization is kept for further systems until the next assemble().
     * Collective.
     */
    int solve(const NodalVector &residual, const NodalVector *const prescribed, const double target,
              NodalVector &change)
    {
      const NodePartition &partition = *problem.model.state.partition();
      const NodalVector &constrained = problem.constrained();
      Vector right_hand_side(owned_rows, partition.communicator()), solution(right_hand_side);
      problem.frames().turn(residual, right_hand_side);
      Vector moved(right_hand_side);
      moved = 0.;
      if (prescribed != nullptr)
      {
        Vector effect(right_hand_side);
        problem.frames().turn(*prescribed, moved);
        coupling.vmult(effect, moved);
        right_hand_side.add(-1., effect);
      }
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          if (constrained.node(i)[d] > 0.)
            right_hand_side.local_element(i * dim + d) = 0.;
      solution = 0.;
      // With less, Newton's method does not converge as it can. Matrices of particles are several
      // times as dense, so that an iteration of the linear solver costs as much as several
      // evaluations.
      const double reduction = problem.model.bridge->has_particles() ? 1e-4 : 1e-8;
      SolverControl control(most_iterations,
                            std::max(target, reduction * right_hand_side.l2_norm()));
      int n_iterations = 0;
      try
      {
        if (solver == Solver::direct)
        {
          if (factorization == nullptr)
          {
            using Direct = TrilinosWrappers::SolverDirect;
            // MUMPS is the faster one; every Trilinos has KLU.
            const char *const name = Amesos().Query("Amesos_Mumps") ? "Amesos_Mumps" : "Amesos_Klu";
            factorization = std::make_unique<Direct>(control_of_factorization,
                                                     Direct::AdditionalData(false, name));
            factorization->initialize(matrix);
          }
          factorization->solve(solution, right_hand_side);
          n_iterations = 1;
        }
        else
        {
          prepare_multigrid();
          SolverGMRES<Vector> gmres(control, SolverGMRES<Vector>::AdditionalData(120, true));
          gmres.solve(matrix, solution, right_hand_side, multigrid);
          n_iterations = static_cast<int>(control.last_step());
        }
      }
      catch (const std::exception &) // no convergence, or a singular matrix
      {
        n_iterations = -1;
      }
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
      {
        for (unsigned int d = 0; d < dim; ++d)
          change.node(i)[d] = constrained.node(i)[d] > 0. ? moved.local_element(i * dim + d)
                                                          : solution.local_element(i * dim + d);
        problem.frames().turn_back(partition.global_index(i), change.node(i));
      }
      change.distribute();
      return n_iterations;
    }

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

    /** The cost of its assemblies in evaluations of the forces of all cells. */
    double evaluations() const
    {
      return (dim * std::pow(problem.model.degree + 1., dim) + 1.) * double(count);
    }

  private:
    /** dim rows a node. */
    static IndexSet rows_of(const IndexSet &nodes)
    {
      IndexSet result(nodes.size() * dim);
      for (const types::global_dof_index node : nodes)
        result.add_range(node * dim, (node + 1) * dim);
      result.compress();
      return result;
    }

    /** A row of the equations: its entries in free and in prescribed columns. */
    struct Row
    {
      void add(const types::global_dof_index column, const double entry, const bool is_prescribed)
      {
        columns[is_prescribed].push_back(column);
        entries[is_prescribed].push_back(entry);
      }

      void move_to(const types::global_dof_index row,
                   const std::array<TrilinosWrappers::SparseMatrix *, 2> &matrices)
      {
        for (const unsigned int k : {0, 1})
        {
          if (!columns[k].empty())
            matrices[k]->add(row, static_cast<unsigned int>(columns[k].size()), columns[k].data(),
                             entries[k].data());
          columns[k].clear();
          entries[k].clear();
        }
      }

      std::array<std::vector<types::global_dof_index>, 2> columns;
      std::array<std::vector<double>, 2> entries;
    };

    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

    void make_pattern(const std::vector<ContactStiffness<dim>> &springs)
    {
      const Model<dim> &model = problem.model;
      const NodePartition &partition = *model.state.partition();
      IndexSet nodes = partition.owned();
      nodes.add_indices(partition.ghosts());
      for (const auto &item : far_constraints)
        nodes.add_index(item.first);
      const IndexSet writable = rows_of(nodes);
      constexpr unsigned int entries_per_row = 0; // unknown; they are allocated as they come
      TrilinosWrappers::SparsityPattern pattern(owned_rows, owned_rows, writable,
                                                partition.communicator(), entries_per_row);
      std::vector<types::global_dof_index> cell_nodes, columns;
      const auto add_nodes = [&]
      {
        columns.clear();
        for (const types::global_dof_index node : dependent.independent(cell_nodes))
          for (unsigned int d = 0; d < dim; ++d)
            columns.push_back(node * dim + d);
        for (const types::global_dof_index row : columns)
          pattern.add_entries(row, columns.begin(), columns.end());
      };
      for (const unsigned int node : partition.dependent_nodes().node)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const types::global_dof_index row = partition.global_index(node) * dim + d;
          pattern.add(row, row);
        }
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        model.nodes->cell_nodes(cell, cell_nodes);
        add_nodes();
      }
      for (const Part<dim> &part : model.parts)
        part.formulation->find_couplings(
            [&](const std::vector<unsigned int> &group)
            {
              cell_nodes.clear();
              for (const unsigned int node : EquationsOfSources::sources_of(partition, group))
                cell_nodes.push_back(partition.global_index(node));
              add_nodes();
            });
      for (const ContactStiffness<dim> &stiffness : springs)
      {
        cell_nodes.clear();
        for (const auto &entry : stiffness.entries)
          cell_nodes.push_back(entry.node);
        add_nodes();
      }
      pattern.compress();
      clear_solvers(); // they refer to the present matrix
      matrix.reinit(pattern);
      coupling.reinit(pattern);
    }

    void add_cell(const CellEquations &equations)
    {
      const NodePartition &partition = *problem.model.state.partition();
      const NodalVector &position = problem.model.state.position;
      const auto n_rows = static_cast<unsigned int>(equations.force.size());
      for (unsigned int row = 0; row < n_rows; ++row)
      {
        const double *const entries = equations.matrix.data() + std::size_t(row) * n_rows;
        double sum = 0, rounded = 0;
        for (unsigned int column = 0; column < n_rows; ++column)
        {
          sum += std::abs(entries[column]);
          rounded += std::abs(entries[column] *
                              position.node(equations.nodes[column / dim])[column % dim]);
        }
        const unsigned int node = equations.nodes[row / dim];
        cell_forces.node(node)[row % dim] += std::abs(equations.force[row]);
        absolute_row_sums.node(node)[row % dim] += sum;
        rounded_forces.node(node)[row % dim] += rounded;
      }
      if (std::any_of(equations.nodes.begin(), equations.nodes.end(),
                      [&](const unsigned int node)
                      { return EquationsOfSources::image(partition, node) != nullptr; }))
      {
        const EquationsOfSources source_equations(partition, equations.nodes, equations.matrix,
                                                  dim);
        add_matrix(source_equations.nodes, source_equations.matrix);
      }
      else
        add_matrix(equations.nodes, equations.matrix);
    }

    void add_matrix(const std::vector<unsigned int> &local_nodes,
                    const std::vector<double> &entries)
    {
      DependentRows::Nodes nodes;
      for (const unsigned int node : local_nodes)
        nodes.push_back(problem.model.state.partition()->global_index(node));
      const DependentRows::Nodes independent_nodes = dependent.independent(nodes);
      if (problem.frames().is_empty() && independent_nodes == nodes)
      {
        add_equations(nodes, entries);
        return;
      }
      std::vector<double> turned =
          independent_nodes == nodes ? entries
                                     : dependent.condensed(nodes, independent_nodes, entries, dim);
      problem.frames().turn(independent_nodes, turned);
      add_equations(independent_nodes, turned);
    }

    void add_spring(const ContactStiffness<dim> &stiffness)
    {
      Row row;
      typename ContactStiffness<dim>::Entries entries;
      for (const auto &entry : stiffness.entries)
        for (const auto &[node, weight] : dependent.weights(entry.node))
          entries.push_back({node, weight * entry.normal, weight * entry.weight,
                             weight * entry.shift, stiffness.along * (weight * entry.shares)});
      std::vector<Tensor<2, dim>> blocks(entries.size());
      for (const auto &at_row : entries)
      {
        for (std::size_t k = 0; k < entries.size(); ++k)
          blocks[k] = problem.frames().block(stiffness, at_row, entries[k]);
        for (unsigned int a = 0; a < dim; ++a)
        {
          if (is_constrained(at_row.node, a))
            continue;
          for (std::size_t k = 0; k < entries.size(); ++k)
            for (unsigned int b = 0; b < dim; ++b)
              row.add(entries[k].node * dim + b, blocks[k][a][b],
                      is_constrained(entries[k].node, b));
          row.move_to(at_row.node * dim + a, {{&matrix, &coupling}});
        }
      }
    }

    /** Adds dim rows and columns a node, by rows of @p entries. */
    void add_equations(const DependentRows::Nodes &nodes, const std::vector<double> &entries)
    {
      const auto n_rows = static_cast<unsigned int>(nodes.size()) * dim;
      std::vector<types::global_dof_index> rows(n_rows);
      std::vector<bool> is_prescribed(n_rows);
      for (unsigned int k = 0; k < n_rows; ++k)
      {
        rows[k] = nodes[k / dim] * dim + k % dim;
        is_prescribed[k] = is_constrained(nodes[k / dim], k % dim);
      }
      Row row;
      for (unsigned int a = 0; a < n_rows; ++a)
      {
        const double *const row_entries = entries.data() + std::size_t(a) * n_rows;
        if (is_prescribed[a])
          row.add(rows[a], std::abs(row_entries[a]), false);
        for (unsigned int b = 0; b < n_rows && !is_prescribed[a]; ++b)
          row.add(rows[b], row_entries[b], is_prescribed[b]);
        row.move_to(rows[a], {{&matrix, &coupling}});
      }
    }

    /** Sets the scale of forces of the problem and the effect of rounding on them. Collective. */
    void find_scales()
    {
      const NodalVector &position = problem.model.state.position;
      std::array<double, 2> squares{};
      for (unsigned int i = 0; i < cell_forces.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double spring_stiffness = spring_bound.node(i)[d];
          absolute_row_sums.node(i)[d] += spring_stiffness;
          squares[0] += std::pow(cell_forces.node(i)[d], 2);
          squares[1] += std::pow(
              rounded_forces.node(i)[d] + spring_stiffness * std::abs(position.node(i)[d]), 2);
        }
      squares = ordered_sum(squares, problem.model.communicator);
      problem.force_scale = std::max(problem.force_scale, std::sqrt(squares[0]));
      problem.round_off = 0.25 * std::numeric_limits<double>::epsilon() * std::sqrt(squares[1]);
    }

    /** Gets from other ranks which components of nodes of springs, and of those on which others
     * depend, are prescribed. Collective. */
    void find_far_constraints(const std::vector<ContactStiffness<dim>> &springs)
    {
      const NodePartition &partition = *problem.model.state.partition();
      DependentRows::Nodes nodes = nodes_of_contacts(springs);
      if (!dependent.is_empty())
      {
        for (unsigned int i = 0; i < partition.n_owned() + partition.n_ghosts(); ++i)
          nodes.push_back(partition.global_index(i));
        nodes = dependent.independent(nodes);
      }
      far_constraints =
          values_of_far_nodes<unsigned int>(nodes, partition,
                                            [&](const unsigned int node)
                                            {
                                              unsigned int bits = 0;
                                              for (unsigned int d = 0; d < dim; ++d)
                                                if (problem.constrained().node(node)[d] > 0.)
                                                  bits |= 1u << d;
                                              return bits;
                                            });
    }

    bool is_constrained(const types::global_dof_index node, const unsigned int component) const
    {
      const NodePartition &partition = *problem.model.state.partition();
      if (partition.has(node))
        return problem.constrained().node(partition.local_index(node))[component] > 0.;
      return ((far_constraints.at(node) >> component) & 1u) != 0;
    }

    /** Rigid modes by mode and row, at present positions. Collective. */
    void find_rigid_modes()
    {
      const NodalState &state = problem.model.state;
      const unsigned int n_nodes = state.partition()->n_owned();
      std::array<double, 4> sums{};
      for (unsigned int i = 0; i < n_nodes; ++i)
      {
        for (unsigned int d = 0; d < dim; ++d)
          sums[d] += state.position.node(i)[d];
        sums[3] += 1.;
      }
      sums = ordered_sum(sums, problem.model.communicator);
      const std::size_t n_rows = std::size_t(n_nodes) * dim;
      rigid_modes.assign(n_rigid_modes<dim> * n_rows, 0.);
      for (unsigned int i = 0; i < n_nodes; ++i)
      {
        std::array<double, 3> arm{};
        for (unsigned int d = 0; d < dim; ++d)
          arm[d] = state.position.node(i)[d] - sums[d] / sums[3];
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::array<double, 6> along = rigid_motion_along<dim>(d, arm);
          for (unsigned int mode = 0; mode < n_rigid_modes<dim>; ++mode)
            rigid_modes[mode * n_rows + std::size_t(i) * dim + d] = along[mode];
        }
        for (unsigned int mode = 0; mode < n_rigid_modes<dim>; ++mode)
          problem.frames().turn(state.partition()->global_index(i),
                                &rigid_modes[mode * n_rows + std::size_t(i) * dim]);
      }
    }

    void prepare_multigrid()
    {
      if (has_multigrid)
        return;
      find_rigid_modes();
      TrilinosWrappers::PreconditionAMG::AdditionalData data;
      data.elliptic = true;
      data.smoother_sweeps = 2;
      data.aggregation_threshold = 0.;
      Teuchos::ParameterList list;
      std::unique_ptr<Epetra_MultiVector> modes_of_data;
      data.set_parameters(list, modes_of_data, matrix);
      list.set("PDE equations", dim);
      list.set("null space: type", "pre-computed");
      list.set("null space: dimension", int(n_rigid_modes<dim>));
      list.set("null space: vectors", rigid_modes.data());
      list.set("null space: add default vectors", false);
      // Chebyshev smoothers and the damping of the prolongation estimate an eigenvalue from a
      // random vector otherwise, and a resumed run would not have the same bits.
      list.set("smoother: type", "symmetric Gauss-Seidel");
      list.set("eigen-analysis: type", "Anorm");
      multigrid.initialize(matrix, list);
      has_multigrid = true;
    }

    void clear_solvers()
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
    /** By node of another rank, a bit for each component. */
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
