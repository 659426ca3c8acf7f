// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/cell_simplices.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cstddef>
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
  CellSimplices<dim>::volumes(const typename SubCells<dim>::Corners &corners,
                              const bool only_positive)
  {
    const auto &sub_cell = SimplexPoints<dim>::instance().sub_cell;
    double simplex_volumes[SimplexLanes<dim>::n_padded];
    SimplexLanes<dim>(corners).find_volumes(simplex_volumes);
    std::array<double, SubCells<dim>::n_sub_cells> result{};
    for (unsigned int s = 0; s < sub_cell.size(); ++s)
      result[sub_cell[s]] += only_positive ? std::max(0., simplex_volumes[s]) : simplex_volumes[s];
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
  void BarycentricCoordinates<dim>::evaluate(const Point<dim> &point,
                                             double (&coordinates)[dim + 1]) const
  {
    const Tensor<1, dim> other_coordinates = inverse * (point - origin);
    coordinates[0] = 1.;
    for (unsigned int k = 0; k < dim; ++k)
    {
      coordinates[k + 1] = other_coordinates[k];
      coordinates[0] -= other_coordinates[k];
    }
  }

  template <int dim>
  SimplexPoints<dim>::SimplexPoints()
  {
    const auto &all = CellSimplices<dim>::all();
    AssertThrow(all.size() == n_simplices, ExcInternalError());
    shares[centre] = all[0].vertices[dim];
    std::size_t n = 0; // of the others
    for (std::size_t s = 0; s < n_simplices; ++s)
    {
      sub_cell[s] = all[s].sub_cell;
      for (unsigned int k = 0; k <= dim; ++k)
      {
        const auto &point = all[s].vertices[k];
        const auto end = shares.begin() + std::ptrdiff_t(n);
        auto found = k == dim ? shares.begin() + centre : std::find(shares.begin(), end, point);
        if (k < dim && found == end)
        {
          AssertThrow(n < centre, ExcInternalError());
          shares[n++] = point;
        }
        const auto number = static_cast<std::uint8_t>(found - shares.begin());
        vertices[s][k] = number;
        points_of_sub_cell[sub_cell[s]] |= 1u << number;
      }
      std::fill(vertices[s].begin() + dim + 1, vertices[s].end(), vertices[s][0]);
    }
    fill_tables();
  }

  template <int dim>
  void SimplexPoints<dim>::fill_tables()
  {
    for (unsigned int k = 0; k <= dim; ++k)
      for (unsigned int s = 0; s < n_padded; ++s)
        vertex_points[k][s] = vertices[s < n_simplices ? s : 0][k];
    for (unsigned int a = 0; a < n_corners; ++a)
      for (unsigned int p = 0; p < 16; ++p)
        corner_shares[a][p] = shares[p < n_points ? p : 0][a];
    for (unsigned int a = 0; a < 8; ++a)
    {
      for (unsigned int p = 0; p < n_points; ++p)
        point_shares[p][a] = a < n_corners ? shares[p][a] : 0.;
      for (unsigned int s = 0; s < n_simplices; ++s)
      {
        simplex_shares[s][a] = 0.;
        for (unsigned int k = 0; k <= dim; ++k)
          simplex_shares[s][a] += point_shares[vertices[s][k]][a];
      }
    }
    for (unsigned int bits = 0; bits < 256; ++bits)
      for (unsigned int s = 0; s < n_simplices; ++s)
        for (unsigned int k = 0; k <= dim; ++k)
        {
          const unsigned int point = vertices[s][k];
          auto &simplices = point < 8 ? simplices_of_low : simplices_of_high;
          if (((bits >> point % 8) & 1u) != 0)
            simplices[bits] |= 1u << s;
        }
  }

  template class CellSimplices<2>;
  template class CellSimplices<3>;
  template class BarycentricCoordinates<2>;
  template class BarycentricCoordinates<3>;
  template struct SimplexPoints<2>;
  template struct SimplexPoints<3>;
} // namespace tombolo
