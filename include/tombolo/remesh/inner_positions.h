// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_matrices.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** ∫ ∇Ψ_J · ∇Ψ_K over a cell. */
  template <int dim>
  std::array<double, CellMatrices<dim>::n_corners * CellMatrices<dim>::n_corners>
  laplacian_of_cell(const typename SubCells<dim>::Corners &corners)
  {
    constexpr unsigned int n_points = SimplexPoints<dim>::n_points;
    const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
    const SimplexLanes<dim> lanes(corners);
    double simplex_products[dim][dim][SimplexLanes<dim>::n_padded]; // without the centre
    for (unsigned int group = 0; group < SimplexLanes<dim>::n_groups; ++group)
    {
      const auto edges = lanes.edges(group);
      const EightDoubles factor = SimplexLanes<dim>::volume_factor / edges.determinant;
      for (unsigned int v = 0; v < dim; ++v)
        for (unsigned int w = 0; w <= v; ++w)
        {
          EightDoubles product = edges.cofactor[v][0] * edges.cofactor[w][0];
          for (unsigned int d = 1; d < dim; ++d)
            product += edges.cofactor[v][d] * edges.cofactor[w][d];
          store_eight(factor * product, simplex_products[v][w] + std::size_t(8) * group);
        }
    }
    double point_matrix[n_points][n_points] = {};
    for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
      for (unsigned int v = 0; v < dim; ++v)
        for (unsigned int w = 0; w < dim; ++w)
          point_matrix[points.vertices[s][v]][points.vertices[s][w]] +=
              simplex_products[std::max(v, w)][std::min(v, w)][s];
    // The sum of every row is zero.
    constexpr unsigned int centre = SimplexPoints<dim>::centre;
    for (unsigned int p = 0; p < centre; ++p)
    {
      double sum = 0;
      for (unsigned int q = 0; q < centre; ++q)
        sum += point_matrix[p][q];
      point_matrix[p][centre] = point_matrix[centre][p] = -sum;
      point_matrix[centre][centre] += sum;
    }
    return points.matrix_of_corners(point_matrix);
  }

  /** ∂x/∂X around nodes, the mean over what is there initially: a vector of each column. */
  template <int dim>
  std::array<NodalVector, dim>
  deformation_at_nodes(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
                       const std::vector<typename SubCells<dim>::Corners> &lattice,
                       const NodalVector &position)
  {
    constexpr unsigned int n = SubCells<dim>::n_corners;
    const auto &partition = position.partition();
    std::array<NodalVector, dim> result;
    NodalVector volume(partition, Quantity::scalar);
    for (NodalVector &column : result)
      column.reinit(partition);
    const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
    const auto add_cell = [&](const std::size_t c)
    {
      const SimplexLanes<dim> lattice_lanes(lattice[c]);
      const SimplexLanes<dim> present(corners_at<dim>(nodes[c], position));
      // ∂x/∂X times the volume, and this one.
      double simplex_values[dim * dim + 1][SimplexLanes<dim>::n_padded];
      for (unsigned int group = 0; group < SimplexLanes<dim>::n_groups; ++group)
      {
        const auto edges = lattice_lanes.edges(group), moved = present.edges(group);
        const auto store = [&](const EightDoubles &value, const unsigned int entry)
        {
          store_eight(SimplexLanes<dim>::volume_factor * value,
                      simplex_values[entry] + std::size_t(8) * group);
        };
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
          {
            EightDoubles sum = moved.edge[0][a] * edges.cofactor[0][b];
            for (unsigned int k = 1; k < dim; ++k)
              sum += moved.edge[k][a] * edges.cofactor[k][b];
            store(sum, a * dim + b);
          }
        store(edges.determinant, dim * dim);
      }
      double corner_values[dim * dim + 1][8];
      for (unsigned int entry = 0; entry <= dim * dim; ++entry)
      {
        EightDoubles sum = 0.;
        for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
          sum += simplex_values[entry][s] * load_eight(points.simplex_shares[s]);
        store_eight(sum, corner_values[entry]);
      }
      for (unsigned int k = 0; k < n; ++k)
      {
        *volume.node(nodes[c][k]) += corner_values[dim * dim][k];
        for (unsigned int b = 0; b < dim; ++b)
          for (unsigned int a = 0; a < dim; ++a)
            result[b].node(nodes[c][k])[a] += corner_values[a * dim + b][k];
      }
    };
    std::vector<NodalVector *> sums{&volume};
    for (NodalVector &column : result)
      sums.push_back(&column);
    add_up(sums,
           [&]
           {
             for (std::size_t c = 0; c < nodes.size(); ++c)
               add_cell(c);
           });
    for (NodalVector &column : result)
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*volume.node(i) > 0.)
          for (unsigned int a = 0; a < dim; ++a)
            column.node(i)[a] /= *volume.node(i);
    return result;
  }

  /**
   * Positions of inner nodes from the present positions of all other nodes: the displacement from
   * the initial lattice is harmonic there, with the functions of CellSimplices. So a lattice that
   * was deformed affinely stays what it is, whatever its grading.
   *
   * @p nodes and @p lattice: local numbers and initial corners of the cells of the part on this
   * rank; @p is_free (scalar, owned nodes): positive where a node is placed anew; @p position
   * receives the result, with current ghosts. @p initial: initial positions. @p reduction: see
   * CellMatrices::solve(). Collective.
   */
  template <int dim>
  void
  place_inner_nodes(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
                    const std::vector<typename SubCells<dim>::Corners> &lattice,
                    const NodalVector &is_free, const NodalVector &initial, NodalVector &position,
                    const double reduction = 0.)
  {
    const auto &partition = position.partition();
    CellMatrices<dim> matrices(partition, nodes.size());
    for (std::size_t cell = 0; cell < nodes.size(); ++cell)
      matrices.add_cell(nodes[cell], laplacian_of_cell<dim>(lattice[cell]));
    const NodalVector nothing(partition);
    NodalVector displacement = difference(position, initial);
    NodalVector preconditioner = matrices.diagonal_of_cells();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (!(*is_free.node(i) > 0.))
        *preconditioner.node(i) = 0.;
    constexpr double tolerance = 1e-14;
    matrices.solve(nothing, preconditioner, tolerance, displacement, reduction);
    position.fill(
        [&](const unsigned int i, double *const value)
        {
          for (unsigned int d = 0; d<dim && * is_free.node(i)> 0.; ++d)
            value[d] = initial.node(i)[d] + displacement.node(i)[d];
        });
  }

  /**
   * A step of inner nodes towards positions at which the initial positions, as functions of the
   * present ones, are harmonic (Winslow). Cells stay apart there where place_inner_nodes() would
   * fold them, above a cavity of the surface. Returns displacements, zero elsewhere.
   *
   * @p lattice: initial corners; @p position: the present ones, of cells that are not turned over,
   * with ghosts. Collective.
   */
  template <int dim>
  NodalVector
  winslow_step(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
               const std::vector<typename SubCells<dim>::Corners> &lattice,
               const NodalVector &is_free, const NodalVector &initial, const NodalVector &position)
  {
    const auto &partition = position.partition();
    // Where the steps lead to: iterations start from there.
    NodalVector harmonic = initial.copy(), result(partition);
    constexpr double reduction = 1e-3; // a step leaves as much of the way to where they lead
    place_inner_nodes<dim>(nodes, corners_at<dim>(nodes, position), is_free, position, harmonic,
                           reduction);
    const std::array<NodalVector, dim> deformation =
        deformation_at_nodes<dim>(nodes, lattice, position);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*is_free.node(i) > 0.)
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            result.node(i)[a] -=
                deformation[b].node(i)[a] * (harmonic.node(i)[b] - initial.node(i)[b]);
    return result;
  }
} // namespace tombolo
