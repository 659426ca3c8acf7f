// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/mesh/readers/text_scanner.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace tombolo
{
  /** A surface of facets as in a file: triangles, in two dimensions the sides of a polygon. */
  template <int dim>
  struct FacetList
  {
    struct Facet
    {
      /** Indices in `vertices`: counter-clockwise as seen from outside of the body; in two
       * dimensions the body is to the left of the way from the first to the second. */
      unsigned int vertex[dim];
    };

    std::vector<dealii::Tensor<1, dim>> vertices; ///< [L]
    std::vector<Facet> facets;
  };

  /** Widens the box from @p low to @p high by a @p point. */
  template <int dim>
  void widen_box(dealii::Tensor<1, dim> &low, dealii::Tensor<1, dim> &high,
                 const dealii::Tensor<1, dim> &point)
  {
    for (unsigned int d = 0; d < dim; ++d)
    {
      low[d] = std::min(low[d], point[d]);
      high[d] = std::max(high[d], point[d]);
    }
  }

  /** The square of the distance of a point from this box, zero within it [L^2]. */
  template <int dim>
  double distance_square_to_box(const dealii::Tensor<1, dim> &low,
                                const dealii::Tensor<1, dim> &high,
                                const dealii::Tensor<1, dim> &point)
  {
    double sum = 0;
    for (unsigned int d = 0; d < dim; ++d)
    {
      const double outside = std::max({low[d] - point[d], point[d] - high[d], 0.});
      sum += outside * outside;
    }
    return sum;
  }

  /** The largest number of facets of a file, all of which are on every rank. */
  constexpr unsigned int largest_number_of_facets = 10000000;

  /** STL, text or binary: each triangle with corners of its own. Normals in the file are not used.
   * Throws MeshFileError, as all of these. */
  FacetList<3> read_stl(std::string_view text);

  /** Wavefront OBJ: vertices and faces, which may be polygons: convex ones are cut into triangles,
   * others refused. Normals, textures, groups and the like are skipped. */
  FacetList<3> read_obj(std::string_view text);

  /** A closed polygon: a line `x, y` per corner; what follows `#` is a comment. */
  FacetList<2> read_polyline(std::string_view text);
} // namespace tombolo
