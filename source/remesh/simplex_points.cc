// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/simplex_points.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cstddef>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  const SimplexPoints<dim> &SimplexPoints<dim>::instance()
  {
    static const SimplexPoints result;
    return result;
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
        of_vertex[k][s] = vertices[s < n_simplices ? s : 0][k];
    for (unsigned int a = 0; a < n_corners; ++a)
      for (unsigned int p = 0; p < 16; ++p)
        of_corner[a][p] = shares[p < n_points ? p : 0][a];
    for (unsigned int a = 0; a < 8; ++a)
    {
      for (unsigned int p = 0; p < n_points; ++p)
        of_point[p][a] = a < n_corners ? shares[p][a] : 0.;
      for (unsigned int s = 0; s < n_simplices; ++s)
      {
        of_simplex[s][a] = 0.;
        for (unsigned int k = 0; k <= dim; ++k)
          of_simplex[s][a] += of_point[vertices[s][k]][a];
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

  template struct SimplexPoints<2>;
  template struct SimplexPoints<3>;
} // namespace tombolo
