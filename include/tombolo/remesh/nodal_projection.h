// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/la_parallel_vector.h>

#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/state/node_partition.h>

#include <algorithm>
#include <array>
#include <memory>

namespace tombolo
{
  /** The largest of the values that cells of all ranks give to each node. First raise(), then
   * share(), then the rest. */
  class NodeMaxima
  {
  public:
    /** Nodes that get no value have @p nothing. */
    explicit NodeMaxima(const std::shared_ptr<const NodePartition> &partition,
                        const double nothing = -1e300)
        : of_nodes(std::make_unique<Vector>(partition->scalars()))
    {
      for (unsigned int i = 0; i < partition->n_owned() + partition->n_ghosts(); ++i)
        of_nodes->local_element(i) = nothing;
    }

    void raise(const unsigned int node, const double value)
    {
      double &of_node = of_nodes->local_element(node);
      of_node = std::max(of_node, value);
    }

    /** Collective. */
    void share()
    {
      of_nodes->compress(dealii::VectorOperation::max);
      of_nodes->update_ghost_values();
    }

    /** Of an owned or ghost node. */
    double operator[](const unsigned int node) const
    {
      return of_nodes->local_element(node);
    }

    template <typename Nodes>
    double largest_of(const Nodes &nodes) const
    {
      double result = (*this)[nodes[0]];
      for (const unsigned int node : nodes)
        result = std::max(result, (*this)[node]);
      return result;
    }

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    std::unique_ptr<Vector> of_nodes; // a Vector that is copied or moved loses its ghosts
  };

  /**
   * The conservative remap of a nodal field: the weighted least squares
   *
   * @verbatim
   *   Σ_K (∫ ρ Ψ⁺_J Ψ⁺_K + δ_JK d_J) z⁺_K = ∫ ρ Ψ⁺_J z⁻ + d_J z⁻_J
   * @endverbatim
   *
   * in the present body, with the functions of CellSimplices and the exact integrals of
   * CellOverlap. d_J is what node J has of @p mass_after beyond the integrals, and never less than
   * zero: the mass of other parts there, and what the lumped masses of cells that stay have. Nodes
   * that have moved get for d what the field is in the mean around them. One shift of all nodes
   * keeps Σ m z. Linear fields stay where d is zero or nodes stay, constant ones everywhere. Nodes
   * that have lost all cells have zero.
   *
   * @p field number @p number of the overlap, node_stride slots; @p mass and @p mass_after: scalar,
   * in the measure of ρ, at owned nodes. @p field gets the values of after, with current ghosts.
   * Collective.
   */
  template <int dim>
  void project_nodal_field(const CellOverlap<dim> &overlap, unsigned int number,
                           const NodalVector &mass, const NodalVector &mass_after,
                           NodalVector &field);

  /**
   * Keeps a field of project_nodal_field() between the values that it had @p before, with ghosts,
   * at nodes up to two cells away: a projection overshoots beside steep gradients. What this adds
   * or takes goes to where there is room for it around cells that have moved, so that Σ m z stays.
   * @p mass: m⁺, at owned nodes. Collective.
   */
  template <int dim>
  void limit_nodal_field(const CellOverlap<dim> &overlap, const NodalVector &before,
                         const NodalVector &mass, NodalVector &field);

  /** ∫ ρ Ψ⁺ of each corner of a cell of after whose sub-cells have these masses [M]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_corners>
  masses_of_corners(const typename SubCells<dim>::Corners &corners, const double *of_sub_cells);
} // namespace tombolo
