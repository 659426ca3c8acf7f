// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/shared_facets.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The two corners of a facet on a face. */
    template <int dim>
    std::array<unsigned int, 2> ends_of(const typename SubCells<dim>::Facet &facet)
    {
      std::array<unsigned int, 2> result;
      for (unsigned int end = 0; end < 2; ++end)
        result[end] = static_cast<unsigned int>(
            std::find(facet.vertices[end].begin(), facet.vertices[end].end(), 1.) -
            facet.vertices[end].begin());
      return result;
    }
  } // namespace

  template <int dim>
  struct SharedFacets<dim>::Face
  {
    std::array<types::global_dof_index, GeometryInfo<dim>::vertices_per_face> nodes; // ascending
    unsigned int cell, face;

    bool operator<(const Face &other) const
    {
      return std::tie(nodes, cell) < std::tie(other.nodes, other.cell);
    }
  };

  template <int dim>
  SharedFacets<dim>::SharedFacets(const std::vector<SmoothedCell<dim>> &cells)
      : numbers(cells.size() * SubCells<dim>::facets().size(), none)
  {
    std::vector<Face> faces;
    for (unsigned int c = 0; c < cells.size(); ++c)
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
      {
        if (cells[c].is_void || cells[c].has_further_nodes() || cells[c].is_on_boundary[face])
          continue;
        Face next;
        unsigned int n = 0;
        for (unsigned int k = 0; k < SubCells<dim>::n_corners; ++k)
          if (((k >> (face / 2)) & 1u) == face % 2)
            next.nodes[n++] = cells[c].nodes[k];
        std::sort(next.nodes.begin(), next.nodes.end());
        next.cell = c;
        next.face = face;
        faces.push_back(next);
      }
    std::sort(faces.begin(), faces.end());
    for (std::size_t k = 1; k < faces.size(); ++k)
      if (faces[k - 1].nodes == faces[k].nodes)
        match(cells, faces[k - 1], faces[k]);
  }

  template <int dim>
  void SharedFacets<dim>::match(const std::vector<SmoothedCell<dim>> &cells, const Face &first,
                                const Face &second)
  {
    const auto &all = SubCells<dim>::facets();
    const auto nodes_of = [&](const Face &face, const std::size_t facet)
    {
      const auto ends = ends_of<dim>(all[facet]);
      return std::minmax({cells[face.cell].nodes[ends[0]], cells[face.cell].nodes[ends[1]]});
    };
    for (std::size_t f = 0; f < all.size(); ++f)
      for (std::size_t g = 0; g < all.size() && all[f].face == first.face; ++g)
        if (all[g].face == second.face && nodes_of(first, f) == nodes_of(second, g))
          numbers[first.cell * all.size() + f] = numbers[second.cell * all.size() + g] = n_shared++;
  }

  template class SharedFacets<2>;
  template class SharedFacets<3>;
} // namespace tombolo
