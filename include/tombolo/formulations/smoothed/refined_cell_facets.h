// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>

#include <array>
#include <vector>

namespace tombolo
{
  /** The facets of a cell with hanging nodes where its nodes are now, in the order of those of its
   * start. @p place_of: the place of a node by its global number. */
  template <int dim, typename PlaceOf>
  std::vector<GradedFacet<dim>> present_facets(const SmoothedCell<dim> &cell,
                                               const PlaceOf &place_of)
  {
    typename SubCells<dim>::Corners corners;
    for (unsigned int k = 0; k < corners.size(); ++k)
      corners[k] = place_of(cell.nodes[k]);
    std::vector<RefinedFace<dim>> faces = cell.refined_faces;
    std::vector<RefinedEdge<dim>> edges = cell.refined_edges;
    for (RefinedFace<dim> &face : faces)
      for (auto &part : face.parts)
        for (unsigned int k = 0; k < part.nodes.size(); ++k)
          part.points[k] = place_of(part.nodes[k]);
    for (RefinedEdge<dim> &edge : edges)
      edge.point = place_of(edge.node);
    std::vector<GradedFacet<dim>> result = graded_facets<dim>(corners, faces, edges);
    const std::vector<GradedFacet<dim>> of_start =
        graded_facets<dim>(cell.corners, cell.refined_faces, cell.refined_edges);
    for (std::size_t f = 0; f < result.size(); ++f)
      result[f].orientation = of_start[f].orientation;
    return result;
  }

  /** The volumes of the sub-cells that these facets bound [L^dim]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_sub_cells>
  volumes_within(const std::vector<GradedFacet<dim>> &facets)
  {
    std::array<double, SubCells<dim>::n_sub_cells> result{};
    const dealii::Point<dim> origin = facets.front().vertices.front().place;
    for (const GradedFacet<dim> &facet : facets)
    {
      const double volume = facet.area() * (facet.centroid() - origin) / dim;
      result[facet.from] += volume;
      if (facet.to != SubCells<dim>::outside)
        result[facet.to] -= volume;
    }
    return result;
  }
} // namespace tombolo
