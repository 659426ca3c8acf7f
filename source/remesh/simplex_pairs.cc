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
    std::size_t n = 0;
    for (std::size_t s = 0; s < n_simplices; ++s)
    {
      bits[s] = 0;
      for (unsigned int k = 0; k <= dim; ++k)
      {
        const auto end = shares.begin() + std::ptrdiff_t(n);
        const auto found = std::find(shares.begin(), end, all[s].vertices[k]);
        const auto number = static_cast<std::size_t>(found - shares.begin());
        if (found == end)
        {
          AssertThrow(n < n_points, ExcInternalError());
          shares[n++] = all[s].vertices[k];
        }
        vertices[s][k] = static_cast<std::uint8_t>(number);
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
      functions[s] = {};
      if (!(volume[s] > 0.))
        continue;
      const BarycentricCoordinates<dim> coordinates(vertices);
      for (unsigned int d = 0; d < dim; ++d)
      {
        functions[s].origin[d] = vertices[0][d];
        for (unsigned int k = 0; k < dim; ++k)
          functions[s].gradient[k][d] = coordinates.gradient(k + 1)[d];
      }
    }
  }

  template <int dim>
  bool SimplexPairs<dim>::start(const typename CellSimplices<dim>::Vertices &of_new)
  {
    overlaps.clear();
    pairs.clear();
    volume_of_new = CellSimplices<dim>::volume(of_new);
    if (!(volume_of_new > 0.))
      return false;
    const BarycentricCoordinates<dim> coordinates(of_new);
    lower = upper = of_new[0];
    for (unsigned int d = 0; d < dim; ++d)
    {
      origin[d] = of_new[0][d];
      for (unsigned int k = 0; k < dim; ++k)
        gradient[k][d] = coordinates.gradient(k + 1)[d];
      double entries[4];
      for (unsigned int k = 0; k < 4; ++k)
        entries[k] = of_new[k <= dim ? k : 0][d];
      vertices[d] = load_node(entries);
      lower[d] = *std::min_element(entries, entries + 4);
      upper[d] = *std::max_element(entries, entries + 4);
    }
    return true;
  }

  template <int dim>
  void SimplexPairs<dim>::add_cell(const SimplexCell<dim> &cell, const std::size_t number)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (upper[d] < cell.lower[d] || cell.upper[d] < lower[d])
        return;
    typename SimplexOverlaps<dim>::Points points; // in the new simplex
    unsigned int behind[dim + 1] = {};            // bits of points
    for (unsigned int first = 0; first < 16; first += 8)
    {
      EightDoubles offset[dim], last = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        offset[d] = load_eight(cell.place[d] + first) - origin[d];
      for (unsigned int k = 0; k < dim; ++k)
      {
        EightDoubles value = gradient[k][0] * offset[0];
        for (unsigned int d = 1; d < dim; ++d)
          value += gradient[k][d] * offset[d];
        last -= value;
        store_eight(value, points[k + 1] + first);
        behind[k + 1] |= bits_of(value <= 0.) << first;
      }
      store_eight(last, points[0] + first);
      behind[0] |= bits_of(last <= 0.) << first;
    }
    const CellPoints<dim> &of_cell = CellPoints<dim>::instance();
    unsigned int candidates[CellPoints<dim>::n_simplices], n_candidates = 0;
    for (unsigned int s = 0; s < CellPoints<dim>::n_simplices; ++s)
    {
      unsigned int is_apart = cell.volume[s] > 0. ? 0 : 1;
      for (const unsigned int of_side : behind)
        is_apart |= (of_cell.bits[s] & ~of_side) == 0 ? 1 : 0;
      candidates[n_candidates] = s;
      n_candidates += 1 - is_apart;
    }
    for (unsigned int c = 0; c < n_candidates; ++c)
    {
      const unsigned int s = candidates[c];
      NodeLanes old_at_new[dim + 1];
      cell.evaluate(s, vertices, old_at_new);
      bool is_apart = false;
      for (unsigned int i = 0; i <= dim; ++i)
        is_apart = is_apart || std::experimental::all_of(old_at_new[i] <= 0.);
      if (is_apart)
        continue;
      pairs.push_back({number, s, {}});
      for (unsigned int i = 0; i <= dim; ++i)
        store_node(old_at_new[i], pairs.back().old_at_new[i]);
      overlaps.add(points, of_cell.vertices[s].data());
    }
  }

  template struct CellPoints<2>;
  template struct CellPoints<3>;
  template class SimplexCell<2>;
  template class SimplexCell<3>;
  template class SimplexPairs<2>;
  template class SimplexPairs<3>;
} // namespace tombolo
