// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/smoothed/sub_cells.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
  static_assert(NodeLanes::size() == node_stride, "A node is one set of lanes.");

  using Slots = std::array<double, node_stride>;

  /** By slot, over the nodes with a positive @p weight. Collective. */
  inline Slots dot_by_slot(const NodalVector &a, const NodalVector &b, const NodalVector &weight)
  {
    const NodePartition &partition = *a.partition();
    NodeLanes rank_sum = 0.;
    for (unsigned int i = 0, n = partition.n_owned(); i < n; ++i)
      if (*weight.node(i) > 0.)
        rank_sum += load_node(a.node(i)) * load_node(b.node(i));
    Slots sum;
    store_node(rank_sum, sum.data());
    return ordered_sum(sum, partition.communicator());
  }

  /** A symmetric matrix of nodes that is a sum over cells, with numbers on the diagonal beside. It
   * acts on all slots of a vector alike. */
  template <int dim>
  class CellMatrices
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;

    /** With room for so many cells. */
    CellMatrices(const std::shared_ptr<const NodePartition> &partition, const std::size_t n_cells)
        : partition(partition)
    {
      nodes_of_cells.reserve(n_cells);
      matrices.reserve(n_cells);
      diagonal.reinit(partition, Quantity::scalar);
    }

    /** @p nodes are local numbers; of the @p matrix the lower triangle is used. */
    void add_cell(const std::array<unsigned int, n_corners> &nodes,
                  const std::array<double, n_corners * n_corners> &matrix)
    {
      nodes_of_cells.push_back(nodes);
      matrices.emplace_back();
      double *entry = matrices.back().data();
      for (unsigned int a = 0; a < n_corners; ++a)
        for (unsigned int b = 0; b <= a; ++b)
          *entry++ = matrix[a * n_corners + b];
    }

    /** Scalar, at owned nodes. */
    NodalVector diagonal;

    /** Owned values of A @p direction, whose ghosts are updated. Collective. */
    void apply(NodalVector &direction, NodalVector &result) const
    {
      direction.update_ghosts();
      result.set_zero();
      for (std::size_t cell = 0; cell < matrices.size(); ++cell)
      {
        NodeLanes from[n_corners];
        for (unsigned int b = 0; b < n_corners; ++b)
          from[b] = load_node(direction.node(nodes_of_cells[cell][b]));
        NodeLanes sum[n_corners];
        const double *entry = matrices[cell].data();
        TOMBOLO_UNROLL
        for (unsigned int a = 0; a < n_corners; ++a)
        {
          sum[a] = 0.;
          TOMBOLO_UNROLL
          for (unsigned int b = 0; b < a; ++b, ++entry)
          {
            sum[a] += *entry * from[b];
            sum[b] += *entry * from[a];
          }
          sum[a] += *entry++ * from[a];
        }
        for (unsigned int a = 0; a < n_corners; ++a)
        {
          double *const to = result.node(nodes_of_cells[cell][a]);
          store_node(load_node(to) + sum[a], to);
        }
      }
      result.add_to_owners();
      for (unsigned int i = 0, n = partition->n_owned(); i < n; ++i)
        store_node(load_node(result.node(i)) + *diagonal.node(i) * load_node(direction.node(i)),
                   result.node(i));
    }

    /** The diagonal of the matrices of the cells, scalar, at owned nodes. Collective. */
    NodalVector diagonal_of_cells() const
    {
      const auto add = [&](NodalVector &sums)
      {
        for (std::size_t cell = 0; cell < matrices.size(); ++cell)
          for (unsigned int a = 0; a < n_corners; ++a)
            *sums.node(nodes_of_cells[cell][a]) += matrices[cell][a * (a + 1) / 2 + a];
      };
      return sums_at_owners(partition, Quantity::scalar, add);
    }

    /**
     * Solves A @p solution = @p right_side at the owned nodes where @p preconditioner (scalar) is
     * positive, by conjugate gradients that it preconditions as a diagonal; elsewhere the solution
     * stays. Ends where each slot of the residual has fallen to @p tolerance of what it would be
     * for no solution, or to @p reduction of what it was, or falls no more. Ghosts of the solution
     * are updated. Returns the number of iterations. Collective.
     */
    unsigned int solve(const NodalVector &right_side, const NodalVector &preconditioner,
                       const double tolerance, NodalVector &solution,
                       const double reduction = 0.) const
    {
      constexpr unsigned int most_iterations = 1000;
      NodalVector residual, preconditioned, direction, product,
          inverse(partition, Quantity::scalar);
      for (NodalVector *const vector : {&residual, &preconditioned, &direction, &product})
        vector->reinit(partition, solution.quantity());
      const unsigned int n_owned = partition->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
        *inverse.node(i) = *preconditioner.node(i) > 0. ? 1. / *preconditioner.node(i) : 0.;
      const auto precondition = [&]()
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          store_node(*inverse.node(i) * load_node(residual.node(i)), preconditioned.node(i));
        preconditioned.make_symmetric();
        return dot_by_slot(residual, preconditioned, preconditioner);
      };
      // The residual without a solution at the free nodes.
      NodalVector start = solution.copy();
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*preconditioner.node(i) > 0.)
          std::fill_n(start.node(i), node_stride, 0.);
      const auto find_residual = [&](NodalVector &of)
      {
        apply(of, product);
        for (unsigned int i = 0; i < n_owned; ++i)
          store_node(load_node(right_side.node(i)) - load_node(product.node(i)), residual.node(i));
        return precondition();
      };
      Slots scale = find_residual(start);
      Slots square = find_residual(solution);
      Slots limit;
      for (unsigned int slot = 0; slot < node_stride; ++slot)
      {
        if (scale[slot] == 0.) // the solution is zero
          scale[slot] = square[slot];
        limit[slot] =
            std::max(tolerance * tolerance * scale[slot], reduction * reduction * square[slot]);
      }
      direction.copy_from(preconditioned);
      unsigned int iteration = 0;
      const auto is_large = [&](const unsigned int slot) { return square[slot] > limit[slot]; };
      for (; iteration < most_iterations; ++iteration)
      {
        if (!is_large(0) && !is_large(1) && !is_large(2) && !is_large(3))
          break;
        apply(direction, product);
        const Slots curvature = dot_by_slot(direction, product, preconditioner);
        Slots step{}, factor{};
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          step[slot] = is_large(slot) && curvature[slot] > 0. ? square[slot] / curvature[slot] : 0.;
        const NodeLanes along = load_node(step.data());
        for (unsigned int i = 0; i < n_owned; ++i)
          if (*preconditioner.node(i) > 0.)
          {
            store_node(load_node(solution.node(i)) + along * load_node(direction.node(i)),
                       solution.node(i));
            store_node(load_node(residual.node(i)) - along * load_node(product.node(i)),
                       residual.node(i));
          }
        const Slots next = precondition();
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          factor[slot] = step[slot] != 0. ? next[slot] / square[slot] : 0.;
        square = next;
        const NodeLanes former_factor = load_node(factor.data());
        for (unsigned int i = 0; i < n_owned; ++i)
          store_node(load_node(preconditioned.node(i)) +
                         former_factor * load_node(direction.node(i)),
                     direction.node(i));
      }
      solution.update_ghosts();
      return iteration;
    }

  private:
    std::shared_ptr<const NodePartition> partition;
    std::vector<std::array<unsigned int, n_corners>> nodes_of_cells;
    std::vector<std::array<double, n_corners *(n_corners + 1) / 2>> matrices; // lower triangles
  };
} // namespace tombolo
