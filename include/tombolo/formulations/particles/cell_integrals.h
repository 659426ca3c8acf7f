// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>

#include <deal.II/fe/fe_values.h>

#include <map>
#include <vector>

namespace tombolo
{
  /** What a cell gives to the averages around its nodes I, with the functions N_J of its nodes J
   * (see CellAverages). */
  template <int dim>
  struct CellIntegrals
  {
    using Node = dealii::types::global_dof_index;

    static constexpr double gradient_sharpness = 2.; ///< s of χ = Π_k (1 ± s ξ_k) / 2
    static constexpr double value_sharpness = 1.5;   ///< of ψ

    /** All zero. */
    CellIntegrals(const std::vector<Node> &nodes, const std::vector<dealii::Point<dim>> &points);

    /** Integrates over a cell whose corners are the nodes; @p hierarchic are their numbers in
     * @p fe_values. */
    void add(const dealii::FEValues<dim> &fe_values, const std::vector<unsigned int> &hierarchic);

    /** The same of the corners, or in the place of those that depend on others, of the others.
     * @p places are those of Nodes::points_depended_on(). */
    CellIntegrals of_nodes_that_move(const Nodes<dim> &of_mesh,
                                     const std::map<Node, dealii::Point<dim>> &places) const;

    std::vector<Node> nodes;
    std::vector<dealii::Point<dim>> points;
    std::vector<double> volume;                   ///< ∫ χ_I
    std::vector<double> weight;                   ///< ∫ ψ_I
    std::vector<dealii::Tensor<1, dim>> moment;   ///< ∫ ψ_I (x - x_I)
    std::vector<double> value;                    ///< ∫ ψ_I N_J, J fastest
    std::vector<dealii::Tensor<1, dim>> gradient; ///< ∫ χ_I ∇N_J
  };
} // namespace tombolo
