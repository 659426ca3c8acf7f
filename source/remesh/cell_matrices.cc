// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_matrices.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    using Slots = std::array<double, node_stride>;

    /** By slot, over the nodes with a positive @p weight. Collective. */
    Slots dot_by_slot(const NodalVector &a, const NodalVector &b, const NodalVector &weight)
    {
      Slots sum{};
      const NodePartition &partition = *a.partition();
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
        if (*weight.node(i) > 0.)
          for (unsigned int slot = 0; slot < node_stride; ++slot)
            sum[slot] += a.node(i)[slot] * b.node(i)[slot];
      return ordered_sum(sum, partition.communicator());
    }
  } // namespace

  template <int dim>
  CellMatrices<dim>::CellMatrices(const std::shared_ptr<const NodePartition> &partition)
      : partition(partition)
  {
    diagonal.reinit(partition, 1);
  }

  template <int dim>
  void CellMatrices<dim>::add_cell(const std::array<unsigned int, n_corners> &nodes,
                                   const std::array<double, n_corners * n_corners> &matrix)
  {
    nodes_of_cells.push_back(nodes);
    matrices.push_back(matrix);
  }

  template <int dim>
  void CellMatrices<dim>::apply(NodalVector &direction, NodalVector &result) const
  {
    direction.update_ghosts();
    result.set_zero();
    static_assert(NodeLanes::size() == node_stride, "A node is one set of lanes.");
    for (std::size_t cell = 0; cell < matrices.size(); ++cell)
    {
      NodeLanes from[n_corners];
      for (unsigned int b = 0; b < n_corners; ++b)
        from[b] = load_node(direction.node(nodes_of_cells[cell][b]));
      for (unsigned int a = 0; a < n_corners; ++a)
      {
        double *const to = result.node(nodes_of_cells[cell][a]);
        NodeLanes sum = load_node(to);
        for (unsigned int b = 0; b < n_corners; ++b)
          sum += matrices[cell][a * n_corners + b] * from[b];
        store_node(sum, to);
      }
    }
    result.add_to_owners();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        result.node(i)[slot] += *diagonal.node(i) * direction.node(i)[slot];
  }

  template <int dim>
  NodalVector CellMatrices<dim>::diagonal_of_cells() const
  {
    NodalVector result;
    result.reinit(partition, 1);
    for (std::size_t cell = 0; cell < matrices.size(); ++cell)
      for (unsigned int a = 0; a < n_corners; ++a)
        *result.node(nodes_of_cells[cell][a]) += matrices[cell][a * n_corners + a];
    result.add_to_owners();
    return result;
  }

  template <int dim>
  unsigned int CellMatrices<dim>::solve(const NodalVector &right_side,
                                        const NodalVector &preconditioner, const double tolerance,
                                        NodalVector &solution) const
  {
    constexpr unsigned int most_iterations = 1000;
    NodalVector residual, preconditioned, direction, product;
    for (NodalVector *const vector : {&residual, &preconditioned, &direction, &product})
      vector->reinit(partition, node_stride, solution.under_reflection());
    const unsigned int n_owned = partition->n_owned();
    const auto precondition = [&]()
    {
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
        {
          const double weight = *preconditioner.node(i);
          preconditioned.node(i)[slot] = weight > 0. ? residual.node(i)[slot] / weight : 0.;
        }
      preconditioned.make_symmetric();
      return dot_by_slot(residual, preconditioned, preconditioner);
    };
    // What the residual is without a solution at the free nodes.
    NodalVector start;
    start.reinit(partition, node_stride, solution.under_reflection());
    start.copy_from(solution);
    for (unsigned int i = 0; i < n_owned; ++i)
      if (*preconditioner.node(i) > 0.)
        std::fill_n(start.node(i), node_stride, 0.);
    const auto find_residual = [&](NodalVector &of)
    {
      apply(of, product);
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          residual.node(i)[slot] = right_side.node(i)[slot] - product.node(i)[slot];
      return precondition();
    };
    Slots scale = find_residual(start);
    Slots square = find_residual(solution);
    for (unsigned int slot = 0; slot < node_stride; ++slot)
      if (scale[slot] == 0.) // the solution is zero
        scale[slot] = square[slot];
    direction.copy_from(preconditioned);
    unsigned int iteration = 0;
    const auto is_large = [&](const unsigned int slot)
    { return square[slot] > tolerance * tolerance * scale[slot]; };
    for (; iteration < most_iterations; ++iteration)
    {
      if (!is_large(0) && !is_large(1) && !is_large(2) && !is_large(3))
        break;
      apply(direction, product);
      const Slots curvature = dot_by_slot(direction, product, preconditioner);
      Slots step{}, factor{};
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        step[slot] = is_large(slot) && curvature[slot] > 0. ? square[slot] / curvature[slot] : 0.;
      for (unsigned int i = 0; i < n_owned; ++i)
        if (*preconditioner.node(i) > 0.)
          for (unsigned int slot = 0; slot < node_stride; ++slot)
          {
            solution.node(i)[slot] += step[slot] * direction.node(i)[slot];
            residual.node(i)[slot] -= step[slot] * product.node(i)[slot];
          }
      const Slots next = precondition();
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        factor[slot] = step[slot] != 0. ? next[slot] / square[slot] : 0.;
      square = next;
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          direction.node(i)[slot] =
              preconditioned.node(i)[slot] + factor[slot] * direction.node(i)[slot];
    }
    solution.update_ghosts();
    return iteration;
  }

  template class CellMatrices<2>;
  template class CellMatrices<3>;
} // namespace tombolo
