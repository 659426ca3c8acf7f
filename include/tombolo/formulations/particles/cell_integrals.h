// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/nodes.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace internal
  {
    /** Π_k (1 ± s ξ_k) / 2 of the corner @p corner at @p point of the unit cell. */
    template <int dim>
    double weight_of_corner(const double sharpness, const unsigned int corner,
                            const dealii::Point<dim> &point)
    {
      double result = 1.;
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double side = ((corner >> d) & 1u) != 0 ? 1. : -1.;
        result *= 0.5 * (1. + side * sharpness * (2. * point[d] - 1.));
      }
      return result;
    }
  } // namespace internal

  /** What a cell adds to averages around its nodes I, with functions N_J (see CellAverages). */
  template <int dim>
  struct CellIntegrals
  {
    using Node = dealii::types::global_dof_index;

    static constexpr double gradient_sharpness = 2.; ///< s of χ = Π_k (1 ± s ξ_k) / 2

    /** A node of a cell of @p n_nodes nodes, which are listed after each other. */
    struct NodeOfCell
    {
      unsigned int n_nodes;
      Node node;
      double volume;      ///< V_cI
      double gradient[3]; ///< of the mean over the cell
    };

    /** All zero. */
    CellIntegrals(const std::vector<Node> &nodes, const std::vector<dealii::Point<dim>> &points)
        : nodes(nodes), points(points), volume(nodes.size()), weight(nodes.size()),
          moment(nodes.size()), value(nodes.size() * nodes.size()),
          gradient(nodes.size() * nodes.size())
    {}

    /** The same with each dependent corner replaced by the nodes that it depends on. @p
     * node_positions are those of Nodes::points_depended_on(). */
    CellIntegrals
    on_independent_nodes(const Nodes<dim> &mesh_nodes,
                         const std::map<Node, dealii::Point<dim>> &node_positions) const
    {
      const std::size_t n_corners = nodes.size();
      std::vector<Node> others;
      std::vector<dealii::Point<dim>> points_of_others;
      std::vector<std::vector<std::pair<std::size_t, double>>> shares(n_corners);
      const auto share = [&](const std::size_t corner, const Node node,
                             const dealii::Point<dim> &point, const double share_of_node)
      {
        const auto found = std::find(others.begin(), others.end(), node);
        shares[corner].emplace_back(found - others.begin(), share_of_node);
        if (found != others.end())
          return;
        others.push_back(node);
        points_of_others.push_back(point);
      };
      for (std::size_t i = 0; i < n_corners; ++i)
        if (const DependentNode *const row = mesh_nodes.dependent_node(nodes[i]))
          for (const auto &[node, share_of_node] : row->weights)
            share(i, node, node_positions.at(node), share_of_node);
        else
          share(i, nodes[i], points[i], 1.);
      CellIntegrals result(others, points_of_others);
      result.squared_edge = squared_edge;
      const std::size_t n = others.size();
      for (std::size_t i = 0; i < n_corners; ++i)
        for (const auto &[a, share_a] : shares[i])
        {
          result.volume[a] += share_a * volume[i];
          result.weight[a] += share_a * weight[i];
          result.moment[a] += share_a * (moment[i] + weight[i] * (points[i] - points_of_others[a]));
          for (std::size_t j = 0; j < n_corners; ++j)
            for (const auto &[b, share_b] : shares[j])
            {
              result.value[a * n + b] += share_a * share_b * value[i * n_corners + j];
              result.gradient[a * n + b] += share_a * share_b * gradient[i * n_corners + j];
            }
        }
      return result;
    }

    /** Appends the nodes, with the means of their gradients over the cell. */
    void list_nodes(std::vector<NodeOfCell> &list) const
    {
      const std::size_t n = nodes.size();
      double volume_of_all = 0;
      for (const double node_volume : volume)
        volume_of_all += node_volume;
      for (std::size_t j = 0; j < n; ++j)
      {
        NodeOfCell node{static_cast<unsigned int>(n), nodes[j], volume[j], {}};
        for (std::size_t i = 0; i < n; ++i)
          for (unsigned int d = 0; d < dim; ++d)
            node.gradient[d] += gradient[i * n + j][d] / volume_of_all;
        list.push_back(node);
      }
    }

    std::vector<Node> nodes;
    std::vector<dealii::Point<dim>> points;
    double squared_edge = 0;                      ///< of its edges, in the mean [L^2]
    std::vector<double> volume;                   ///< ∫ χ_I
    std::vector<double> weight;                   ///< ∫ ψ_I
    std::vector<dealii::Tensor<1, dim>> moment;   ///< ∫ ψ_I (x - x_I)
    std::vector<double> value;                    ///< ∫ ψ_I N_J, J fastest
    std::vector<dealii::Tensor<1, dim>> gradient; ///< ∫ χ_I ∇N_J
  };

  /** Finds the integrals of cells one after the other. */
  template <int dim>
  class CellQuadrature
  {
  public:
    /** @p value_sharpness is s of ψ. */
    CellQuadrature(const Nodes<dim> &nodes, const double value_sharpness)
        : quadrature(2),
          fe_values(nodes.dof_handler().get_fe(), quadrature,
                    dealii::update_values | dealii::update_gradients |
                        dealii::update_quadrature_points | dealii::update_JxW_values),
          cell_dofs(fe_values.dofs_per_cell), integrals({}, {})
    {
      for (const dealii::Point<dim> &point : quadrature.get_points())
        for (unsigned int i = 0; i < n; ++i)
        {
          gradient_weights.push_back(
              internal::weight_of_corner<dim>(CellIntegrals<dim>::gradient_sharpness, i, point));
          value_weights.push_back(internal::weight_of_corner<dim>(value_sharpness, i, point));
        }
    }

    /** Of the cell with these nodes at @p points, its corners. The reference stays valid until the
     * next call. */
    const CellIntegrals<dim> &integrate(const typename Nodes<dim>::Cell &cell,
                                        const std::vector<dealii::types::global_dof_index> &nodes,
                                        const std::vector<dealii::Point<dim>> &points)
    {
      cell->get_dof_indices(cell_dofs);
      last_hierarchic.swap(hierarchic);
      hierarchic.clear();
      for (const dealii::types::global_dof_index node : nodes)
        hierarchic.push_back(static_cast<unsigned int>(
            std::find(cell_dofs.begin(), cell_dofs.end(), node) - cell_dofs.begin()));
      fe_values.reinit(cell);
      if (fe_values.get_cell_similarity() != dealii::CellSimilarity::translation ||
          hierarchic != last_hierarchic)
      {
        integrals = CellIntegrals<dim>(nodes, points);
        integrate_functions();
      }
      integrals.nodes = nodes;
      integrals.points = points;
      std::fill(integrals.moment.begin(), integrals.moment.end(), dealii::Tensor<1, dim>());
      for (const unsigned int q : fe_values.quadrature_point_indices())
        for (unsigned int i = 0; i < n; ++i)
          integrals.moment[i] += value_weights[q * n + i] * fe_values.JxW(q) *
                                 (fe_values.quadrature_point(q) - points[i]);
      integrals.squared_edge = 0;
      for (unsigned int line = 0; line < cell->n_lines(); ++line)
      {
        using Info = dealii::GeometryInfo<dim>;
        integrals.squared_edge +=
            cell->vertex(Info::line_to_cell_vertices(line, 0))
                .distance_square(cell->vertex(Info::line_to_cell_vertices(line, 1))) /
            cell->n_lines();
      }
      return integrals;
    }

  private:
    static constexpr unsigned int n = dealii::GeometryInfo<dim>::vertices_per_cell;

    /** Those that are the same in a cell that is translated. */
    void integrate_functions()
    {
      for (const unsigned int q : fe_values.quadrature_point_indices())
        for (unsigned int i = 0; i < n; ++i)
        {
          const double gradient_weight = gradient_weights[q * n + i] * fe_values.JxW(q);
          const double value_weight = value_weights[q * n + i] * fe_values.JxW(q);
          integrals.volume[i] += gradient_weight;
          integrals.weight[i] += value_weight;
          for (unsigned int j = 0; j < n; ++j)
          {
            integrals.value[i * n + j] += value_weight * fe_values.shape_value(hierarchic[j], q);
            integrals.gradient[i * n + j] +=
                gradient_weight * fe_values.shape_grad(hierarchic[j], q);
          }
        }
    }

    dealii::QGauss<dim> quadrature;
    dealii::FEValues<dim> fe_values;
    std::vector<double> gradient_weights, value_weights; ///< χ, ψ, the corner fastest
    std::vector<dealii::types::global_dof_index> cell_dofs;
    std::vector<unsigned int> hierarchic, last_hierarchic; ///< numbers of the nodes in fe_values
    CellIntegrals<dim> integrals;
  };
} // namespace tombolo
