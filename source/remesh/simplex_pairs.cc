// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/simplex_pairs.h>

#include <tombolo/base/simd/eight_doubles.h>

#include <algorithm>
#include <cstddef>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  const CellPoints<dim> &CellPoints<dim>::instance()
  {
    static const CellPoints result;
    return result;
  }

  template <int dim>
  CellPoints<dim>::CellPoints()
  {
    const auto &all = CellSimplices<dim>::all();
    AssertThrow(all.size() == n_simplices, ExcInternalError());
    shares[centre] = all[0].vertices[dim];
    std::size_t n = 0; // of the others
    for (std::size_t s = 0; s < n_simplices; ++s)
    {
      bits[s] = 0;
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
        bits[s] |= 1u << number;
      }
      std::fill(vertices[s].begin() + dim + 1, vertices[s].end(), vertices[s][0]);
    }
  }

  template <int dim>
  SimplexCell<dim>::SimplexCell(const typename SubCells<dim>::Corners &corners)
  {
    const CellPoints<dim> &points = CellPoints<dim>::instance();
    std::array<Point<dim>, CellPoints<dim>::n_points> places;
    for (unsigned int p = 0; p < places.size(); ++p)
    {
      places[p] = SubCells<dim>::point_at(points.shares[p], corners);
      for (unsigned int d = 0; d < dim; ++d)
      {
        place[d][p] = places[p][d];
        lower[d] = p == 0 ? places[p][d] : std::min(lower[d], places[p][d]);
        upper[d] = p == 0 ? places[p][d] : std::max(upper[d], places[p][d]);
      }
    }
    for (unsigned int d = 0; d < dim; ++d)
      std::fill(place[d] + places.size(), place[d] + 16, place[d][0]);
    for (unsigned int s = 0; s < volume.size(); ++s)
    {
      typename CellSimplices<dim>::Vertices vertices;
      for (unsigned int k = 0; k <= dim; ++k)
        vertices[k] = places[points.vertices[s][k]];
      volume[s] = std::max(0., CellSimplices<dim>::volume(vertices));
      gradients_of_simplices[s] = {};
      if (!(volume[s] > 0.))
        continue;
      const BarycentricCoordinates<dim> coordinates(vertices);
      for (unsigned int k = 0; k <= dim; ++k)
      {
        const Tensor<1, dim> gradient = coordinates.gradient(k);
        for (unsigned int d = 0; d < dim; ++d)
          gradients_of_simplices[s].entries[d][k] = gradient[d];
      }
    }
  }

  template <int dim>
  bool SimplexPairs<dim>::start(const typename CellSimplices<dim>::Vertices &of_new)
  {
    overlaps.clear();
    n_pairs = 0;
    volume_of_new = CellSimplices<dim>::volume(of_new);
    if (!(volume_of_new > 0.))
      return false;
    vertices = of_new;
    const BarycentricCoordinates<dim> coordinates(of_new);
    for (unsigned int k = 0; k < dim; ++k)
    {
      const Tensor<1, dim> of_coordinate = coordinates.gradient(k + 1);
      for (unsigned int d = 0; d < dim; ++d)
        gradient[k][d] = of_coordinate[d];
    }
    lower = upper = of_new[0];
    for (const Point<dim> &vertex : of_new)
      for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = std::min(lower[d], vertex[d]);
        upper[d] = std::max(upper[d], vertex[d]);
      }
    return true;
  }

  template <int dim>
  unsigned int
  SimplexPairs<dim>::find_candidates(const SimplexCell<dim> &cell,
                                     const unsigned int (&behind)[dim + 1],
                                     unsigned int (&candidates)[CellPoints<dim>::n_simplices])
  {
    constexpr unsigned int n = CellPoints<dim>::n_simplices;
    const CellPoints<dim> &of_cell = CellPoints<dim>::instance();
    unsigned int is_left[n], result = 0;
    for (unsigned int s = 0; s < n; ++s)
    {
      unsigned int is_in_front = cell.volume[s] > 0. ? 1 : 0;
      for (const unsigned int of_side : behind)
        is_in_front &= (of_cell.bits[s] & ~of_side) != 0 ? 1 : 0;
      is_left[s] = is_in_front;
    }
    for (unsigned int s = 0; s < n; ++s)
    {
      candidates[result] = s;
      result += is_left[s];
    }
    return result;
  }

  template <int dim>
  void SimplexPairs<dim>::add_cell(const SimplexCell<dim> &cell, const std::size_t number)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (upper[d] < cell.lower[d] || cell.upper[d] < lower[d])
        return;
    typename SimplexOverlaps<dim>::Points points; // in the new simplex
    unsigned int behind[dim + 1] = {};
    for (unsigned int first = 0; first < 16; first += 8)
    {
      EightDoubles offset[dim], last = 1.;
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
        offset[d] = load_eight(cell.place[d] + first) - vertices[0][d];
      TOMBOLO_UNROLL
      for (unsigned int k = 0; k < dim; ++k)
      {
        EightDoubles value = gradient[k][0] * offset[0];
        TOMBOLO_UNROLL
        for (unsigned int d = 1; d < dim; ++d)
          value += gradient[k][d] * offset[d];
        last -= value;
        store_eight(value, points[k + 1] + first);
        behind[k + 1] |= bits_of(value <= 0.) << first;
      }
      store_eight(last, points[0] + first);
      behind[0] |= bits_of(last <= 0.) << first;
    }
    unsigned int candidates[CellPoints<dim>::n_simplices];
    const unsigned int n_candidates = find_candidates(cell, behind, candidates);
    if (pairs.size() < n_pairs + n_candidates)
      pairs.resize(n_pairs + n_candidates);
    double from_centre[dim + 1][dim]; // of the vertices of the new simplex
    for (unsigned int k = 0; k <= dim; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        from_centre[k][d] = vertices[k][d] - cell.place[d][CellPoints<dim>::centre];
    double of_centre[4]; // its coordinates; with an entry beyond, which is always in front
    for (unsigned int i = 0; i < 4; ++i)
      of_centre[i] = i >= dim ? 1. : 0.;
    for (unsigned int c = 0; c < n_candidates; ++c)
    {
      const unsigned int s = candidates[c];
      const double(&of_old)[dim][4] = cell.gradients(s);
      Pair &pair = pairs[n_pairs];
      NodeLanes largest;
      TOMBOLO_UNROLL
      for (unsigned int k = 0; k <= dim; ++k)
      {
        NodeLanes value = load_node(of_centre);
        TOMBOLO_UNROLL
        for (unsigned int d = 0; d < dim; ++d)
          value += from_centre[k][d] * load_node(of_old[d]);
        store_node(value, pair.old_at_new[k]);
        largest = k == 0 ? value : std::experimental::max(largest, value);
      }
      if (std::experimental::any_of(largest <= 0.))
        continue;
      pair.cell = number;
      pair.simplex = s;
      ++n_pairs;
      overlaps.add(points, CellPoints<dim>::instance().vertices[s].data());
    }
  }

  template struct CellPoints<2>;
  template struct CellPoints<3>;
  template class SimplexCell<2>;
  template class SimplexCell<3>;
  template class SimplexPairs<2>;
  template class SimplexPairs<3>;
} // namespace tombolo
