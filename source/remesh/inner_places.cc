// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/inner_places.h>

#include <tombolo/remesh/cell_matrices.h>
#include <tombolo/remesh/corners_at.h>
#include <tombolo/remesh/simplex_pairs.h>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** ∫ ∇Ψ_J · ∇Ψ_K over a cell. */
    template <int dim>
    std::array<double, CellMatrices<dim>::n_corners * CellMatrices<dim>::n_corners>
    laplacian_of_cell(const typename SubCells<dim>::Corners &corners)
    {
      constexpr unsigned int n = CellMatrices<dim>::n_corners, n_points = CellPoints<dim>::n_points;
      const CellPoints<dim> &points = CellPoints<dim>::instance();
      const auto &all = CellSimplices<dim>::all();
      double of_points[n_points][n_points] = {}, half[n_points][n] = {};
      for (std::size_t s = 0; s < all.size(); ++s)
      {
        const auto vertices = CellSimplices<dim>::vertices(all[s], corners);
        const BarycentricCoordinates<dim> coordinates(vertices);
        const double volume = CellSimplices<dim>::volume(vertices);
        std::array<Tensor<1, dim>, dim + 1> gradient;
        for (unsigned int v = 0; v <= dim; ++v)
          gradient[v] = coordinates.gradient(v);
        for (unsigned int v = 0; v <= dim; ++v)
          for (unsigned int w = 0; w <= dim; ++w)
            of_points[points.vertices[s][v]][points.vertices[s][w]] +=
                volume * (gradient[v] * gradient[w]);
      }
      for (unsigned int p = 0; p < n_points; ++p)
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int k = 0; k < n; ++k)
            half[p][k] += of_points[p][q] * points.shares[q][k];
      std::array<double, n * n> result{};
      for (unsigned int p = 0; p < n_points; ++p)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int k = 0; k < n; ++k)
            result[j * n + k] += points.shares[p][j] * half[p][k];
      return result;
    }

    /** ∂x/∂X around nodes, the mean over what is there initially: a vector of each column. */
    template <int dim>
    std::array<NodalVector, dim> deformation_at_nodes(
        const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
        const std::vector<typename SubCells<dim>::Corners> &lattice, const NodalVector &position)
    {
      constexpr unsigned int n = SubCells<dim>::n_corners;
      const auto &partition = position.partition();
      std::array<NodalVector, dim> result;
      NodalVector volume;
      volume.reinit(partition, 1);
      for (NodalVector &column : result)
        column.reinit(partition);
      const CellPoints<dim> &points = CellPoints<dim>::instance();
      const auto &all = CellSimplices<dim>::all();
      for (std::size_t c = 0; c < nodes.size(); ++c)
      {
        const typename SubCells<dim>::Corners present = corners_at<dim>(nodes[c], position);
        double volume_of_points[CellPoints<dim>::n_points] = {};
        std::array<Tensor<2, dim>, CellPoints<dim>::n_points> of_points;
        for (std::size_t s = 0; s < all.size(); ++s)
        {
          const auto vertices = CellSimplices<dim>::vertices(all[s], lattice[c]);
          const auto moved = CellSimplices<dim>::vertices(all[s], present);
          const BarycentricCoordinates<dim> coordinates(vertices);
          const double share = CellSimplices<dim>::volume(vertices) / (dim + 1);
          Tensor<2, dim> deformation;
          for (unsigned int v = 0; v <= dim; ++v)
            deformation += outer_product(Tensor<1, dim>(moved[v]), coordinates.gradient(v));
          for (unsigned int v = 0; v <= dim; ++v)
          {
            volume_of_points[points.vertices[s][v]] += share;
            of_points[points.vertices[s][v]] += share * deformation;
          }
        }
        for (unsigned int p = 0; p < of_points.size(); ++p)
          for (unsigned int k = 0; k < n; ++k)
          {
            const double share = points.shares[p][k];
            *volume.node(nodes[c][k]) += share * volume_of_points[p];
            for (unsigned int b = 0; b < dim; ++b)
              for (unsigned int a = 0; a < dim; ++a)
                result[b].node(nodes[c][k])[a] += share * of_points[p][a][b];
          }
      }
      volume.add_to_owners();
      for (NodalVector &column : result)
      {
        column.add_to_owners();
        for (unsigned int i = 0; i < partition->n_owned(); ++i)
          if (*volume.node(i) > 0.)
            for (unsigned int a = 0; a < dim; ++a)
              column.node(i)[a] /= *volume.node(i);
      }
      return result;
    }
  } // namespace

  template <int dim>
  void
  place_inner_nodes(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
                    const std::vector<typename SubCells<dim>::Corners> &lattice,
                    const NodalVector &is_free, const NodalVector &initial, NodalVector &position)
  {
    const auto &partition = position.partition();
    CellMatrices<dim> matrices(partition);
    for (std::size_t cell = 0; cell < nodes.size(); ++cell)
      matrices.add_cell(nodes[cell], laplacian_of_cell<dim>(lattice[cell]));
    NodalVector displacement, nothing;
    for (NodalVector *const vector : {&displacement, &nothing})
      vector->reinit(partition);
    const auto n_values = std::size_t(partition->n_owned()) * node_stride;
    for (std::size_t i = 0; i < n_values; ++i)
      displacement.data()[i] = position.data()[i] - initial.data()[i];
    NodalVector preconditioner = matrices.diagonal_of_cells();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (!(*is_free.node(i) > 0.))
        *preconditioner.node(i) = 0.;
    constexpr double tolerance = 1e-14;
    matrices.solve(nothing, preconditioner, tolerance, displacement);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*is_free.node(i) > 0.)
        for (unsigned int d = 0; d < dim; ++d)
          position.node(i)[d] = initial.node(i)[d] + displacement.node(i)[d];
    position.update_ghosts();
  }

  template <int dim>
  NodalVector
  winslow_step(const std::vector<std::array<unsigned int, SubCells<dim>::n_corners>> &nodes,
               const std::vector<typename SubCells<dim>::Corners> &lattice,
               const NodalVector &is_free, const NodalVector &initial, const NodalVector &position)
  {
    const auto &partition = position.partition();
    std::vector<typename SubCells<dim>::Corners> present(nodes.size());
    for (std::size_t c = 0; c < nodes.size(); ++c)
      present[c] = corners_at<dim>(nodes[c], position);
    NodalVector harmonic, result;
    harmonic.reinit(partition, node_stride, initial.under_reflection());
    harmonic.copy_from(initial);
    place_inner_nodes<dim>(nodes, present, is_free, position, harmonic);
    const std::array<NodalVector, dim> deformation =
        deformation_at_nodes<dim>(nodes, lattice, position);
    result.reinit(partition);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*is_free.node(i) > 0.)
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            result.node(i)[a] -=
                deformation[b].node(i)[a] * (harmonic.node(i)[b] - initial.node(i)[b]);
    return result;
  }

  template NodalVector winslow_step<2>(const std::vector<std::array<unsigned int, 4>> &,
                                       const std::vector<SubCells<2>::Corners> &,
                                       const NodalVector &, const NodalVector &,
                                       const NodalVector &);
  template NodalVector winslow_step<3>(const std::vector<std::array<unsigned int, 8>> &,
                                       const std::vector<SubCells<3>::Corners> &,
                                       const NodalVector &, const NodalVector &,
                                       const NodalVector &);
  template void place_inner_nodes<2>(const std::vector<std::array<unsigned int, 4>> &,
                                     const std::vector<SubCells<2>::Corners> &, const NodalVector &,
                                     const NodalVector &, NodalVector &);
  template void place_inner_nodes<3>(const std::vector<std::array<unsigned int, 8>> &,
                                     const std::vector<SubCells<3>::Corners> &, const NodalVector &,
                                     const NodalVector &, NodalVector &);
} // namespace tombolo
