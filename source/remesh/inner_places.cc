// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/inner_places.h>

#include <tombolo/remesh/cell_matrices.h>

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
      constexpr unsigned int n = CellMatrices<dim>::n_corners;
      std::array<double, n * n> result{};
      for (const auto &simplex : CellSimplices<dim>::all())
      {
        const auto vertices = CellSimplices<dim>::vertices(simplex, corners);
        const BarycentricCoordinates<dim> coordinates(vertices);
        const double volume = CellSimplices<dim>::volume(vertices);
        std::array<Tensor<1, dim>, n> gradient;
        for (unsigned int v = 0; v <= dim; ++v)
          for (unsigned int k = 0; k < n; ++k)
            gradient[k] += simplex.vertices[v][k] * coordinates.gradient(v);
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int k = 0; k < n; ++k)
            result[j * n + k] += volume * (gradient[j] * gradient[k]);
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

  template void place_inner_nodes<2>(const std::vector<std::array<unsigned int, 4>> &,
                                     const std::vector<SubCells<2>::Corners> &, const NodalVector &,
                                     const NodalVector &, NodalVector &);
  template void place_inner_nodes<3>(const std::vector<std::array<unsigned int, 8>> &,
                                     const std::vector<SubCells<3>::Corners> &, const NodalVector &,
                                     const NodalVector &, NodalVector &);
} // namespace tombolo
