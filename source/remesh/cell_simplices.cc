// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_simplices.h>

#include <tombolo/remesh/simplex_lanes.h>

#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::vector<typename CellSimplices<dim>::Simplex> make_simplices()
    {
      typename SubCells<dim>::Corners unit;
      typename SubCells<dim>::Shares centre;
      for (unsigned int corner = 0; corner < unit.size(); ++corner)
      {
        unit[corner] = GeometryInfo<dim>::unit_cell_vertex(corner);
        centre[corner] = 1. / static_cast<double>(unit.size());
      }
      std::vector<typename CellSimplices<dim>::Simplex> result;
      for (const auto &facet : SubCells<dim>::facets())
      {
        if (facet.to != SubCells<dim>::outside)
          continue;
        typename CellSimplices<dim>::Simplex simplex;
        for (unsigned int k = 0; k < dim; ++k)
          simplex.vertices[k] = facet.vertices[k];
        simplex.vertices[dim] = centre;
        simplex.sub_cell = facet.from;
        if (CellSimplices<dim>::volume(CellSimplices<dim>::vertices(simplex, unit)) < 0.)
          std::swap(simplex.vertices[0], simplex.vertices[1]);
        result.push_back(simplex);
      }
      return result;
    }
  } // namespace

  template <int dim>
  const std::vector<typename CellSimplices<dim>::Simplex> &CellSimplices<dim>::all()
  {
    static const std::vector<Simplex> result = make_simplices<dim>();
    return result;
  }

  template <int dim>
  typename CellSimplices<dim>::Vertices
  CellSimplices<dim>::vertices(const Simplex &simplex,
                               const typename SubCells<dim>::Corners &corners)
  {
    Vertices result;
    for (unsigned int k = 0; k <= dim; ++k)
      result[k] = SubCells<dim>::point_at(simplex.vertices[k], corners);
    return result;
  }

  template <int dim>
  double CellSimplices<dim>::volume(const Vertices &vertices)
  {
    Tensor<2, dim> edges;
    for (unsigned int k = 0; k < dim; ++k)
      edges[k] = vertices[k + 1] - vertices[0];
    return determinant(edges) / (dim == 3 ? 6. : 2.);
  }

  template <int dim>
  bool CellSimplices<dim>::are_positive(const typename SubCells<dim>::Corners &corners)
  {
    const SimplexLanes<dim> lanes(corners);
    unsigned int result = 0xFFu;
    for (unsigned int group = 0; group < SimplexLanes<dim>::n_groups; ++group)
      result &= bits_of(SimplexLanes<dim>::volume_factor * lanes.edges(group).determinant > 0.);
    return result == 0xFFu;
  }

  template <int dim>
  std::array<double, SubCells<dim>::n_sub_cells>
  CellSimplices<dim>::volumes(const typename SubCells<dim>::Corners &corners)
  {
    const auto &sub_cell = SimplexPoints<dim>::instance().sub_cell;
    double of_simplices[SimplexLanes<dim>::n_padded];
    SimplexLanes<dim>(corners).find_volumes(of_simplices);
    std::array<double, SubCells<dim>::n_sub_cells> result{};
    for (unsigned int s = 0; s < sub_cell.size(); ++s)
      result[sub_cell[s]] += of_simplices[s];
    return result;
  }

  template <int dim>
  BarycentricCoordinates<dim>::BarycentricCoordinates(
      const typename CellSimplices<dim>::Vertices &vertices)
      : origin(vertices[0])
  {
    Tensor<2, dim> edges; // as columns
    for (unsigned int k = 0; k < dim; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        edges[d][k] = vertices[k + 1][d] - vertices[0][d];
    inverse = invert(edges);
  }

  template <int dim>
  void BarycentricCoordinates<dim>::evaluate(const Point<dim> &place,
                                             double (&coordinates)[dim + 1]) const
  {
    const Tensor<1, dim> of_others = inverse * (place - origin);
    coordinates[0] = 1.;
    for (unsigned int k = 0; k < dim; ++k)
    {
      coordinates[k + 1] = of_others[k];
      coordinates[0] -= of_others[k];
    }
  }

  template <int dim>
  Tensor<1, dim> BarycentricCoordinates<dim>::gradient(const unsigned int k) const
  {
    if (k > 0)
      return inverse[k - 1];
    Tensor<1, dim> result;
    for (unsigned int j = 0; j < dim; ++j)
      result -= inverse[j];
    return result;
  }

  template class CellSimplices<2>;
  template class CellSimplices<3>;
  template class BarycentricCoordinates<2>;
  template class BarycentricCoordinates<3>;
} // namespace tombolo
