// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/sub_cells.h>

#include <type_traits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    using SharesOf = typename SubCells<dim>::Shares;

    template <int dim>
    SharesOf<dim> corner_alone(const unsigned int corner)
    {
      SharesOf<dim> shares{};
      shares[corner] = 1.;
      return shares;
    }

    template <int dim>
    SharesOf<dim> mean_of(const std::vector<SharesOf<dim>> &points)
    {
      SharesOf<dim> mean{};
      for (const SharesOf<dim> &point : points)
        for (unsigned int corner = 0; corner < mean.size(); ++corner)
          mean[corner] += point[corner] / static_cast<double>(points.size());
      return mean;
    }

    /** The corners of a face of the unit cell: those with bit @p axis equal to @p side. */
    template <int dim>
    std::vector<unsigned int> corners_of_face(const unsigned int face)
    {
      std::vector<unsigned int> result;
      for (unsigned int corner = 0; corner < SubCells<dim>::n_corners; ++corner)
        if (SubCells<dim>::is_on_face(corner, face))
          result.push_back(corner);
      return result;
    }

    template <int dim>
    SharesOf<dim> centre_of(const std::vector<unsigned int> &corners)
    {
      std::vector<SharesOf<dim>> points;
      for (const unsigned int corner : corners)
        points.push_back(corner_alone<dim>(corner));
      return mean_of<dim>(points);
    }

    template <int dim>
    SharesOf<dim> centre_of_cell()
    {
      SharesOf<dim> shares;
      shares.fill(1. / SubCells<dim>::n_corners);
      return shares;
    }

    template <int dim>
    typename SubCells<dim>::Corners unit_corners()
    {
      typename SubCells<dim>::Corners corners;
      for (unsigned int corner = 0; corner < corners.size(); ++corner)
        corners[corner] = GeometryInfo<dim>::unit_cell_vertex(corner);
      return corners;
    }

    /** A facet whose normal has the direction of @p direction in the unit cell. */
    template <int dim>
    typename SubCells<dim>::Facet
    make_facet(const std::array<SharesOf<dim>, dim> &vertices, const Tensor<1, dim> &direction,
               const unsigned int from, const unsigned int to, const unsigned int face)
    {
      typename SubCells<dim>::Facet facet;
      facet.vertices = vertices;
      facet.centroid = mean_of<dim>({vertices.begin(), vertices.end()});
      facet.orientation = 1.;
      facet.from = from;
      facet.to = to;
      facet.face = face;
      if (SubCells<dim>::area(facet, unit_corners<dim>()) * direction < 0.)
        facet.orientation = -1.;
      return facet;
    }

    std::vector<SubCells<2>::Facet> make_facets(std::integral_constant<int, 2> /*dim*/)
    {
      constexpr unsigned int n_faces = GeometryInfo<2>::faces_per_cell;
      const auto unit = unit_corners<2>();
      const auto centre = centre_of_cell<2>();
      const Point<2> middle(0.5, 0.5);
      std::vector<SubCells<2>::Facet> result;
      for (unsigned int face = 0; face < n_faces; ++face)
      {
        const auto ends = corners_of_face<2>(face);
        const Tensor<1, 2> outward = SubCells<2>::point_at(centre_of<2>(ends), unit) - middle;
        result.push_back(make_facet<2>({{corner_alone<2>(ends[0]), corner_alone<2>(ends[1])}},
                                       outward, face, SubCells<2>::outside, face));
      }
      for (unsigned int corner = 0; corner < SubCells<2>::n_corners; ++corner)
      {
        const unsigned int x_face = corner & 1u, y_face = 2 + ((corner >> 1) & 1u);
        const Tensor<1, 2> across =
            SubCells<2>::point_at(centre_of<2>(corners_of_face<2>(y_face)), unit) -
            SubCells<2>::point_at(centre_of<2>(corners_of_face<2>(x_face)), unit);
        result.push_back(
            make_facet<2>({{corner_alone<2>(corner), centre}}, across, x_face, y_face, n_faces));
      }
      return result;
    }

    /** The number of a sub-cell is half of that of its even corner. */
    std::vector<SubCells<3>::Facet> make_facets(std::integral_constant<int, 3> /*dim*/)
    {
      constexpr unsigned int n_faces = GeometryInfo<3>::faces_per_cell;
      const auto unit = unit_corners<3>();
      const auto centre = centre_of_cell<3>();
      const Point<3> middle(0.5, 0.5, 0.5);
      std::vector<SubCells<3>::Facet> result;
      for (unsigned int face = 0; face < n_faces; ++face)
      {
        const auto corners = corners_of_face<3>(face);
        const auto face_centre = centre_of<3>(corners);
        const Tensor<1, 3> outward = SubCells<3>::point_at(face_centre, unit) - middle;
        for (const unsigned int corner : corners)
        {
          std::vector<unsigned int> neighbours; // along the edges of the face
          for (unsigned int axis = 0; axis < 3; ++axis)
            if (axis != face / 2)
              neighbours.push_back(corner ^ (1u << axis));
          if (SubCells<3>::is_even(corner))
            for (const unsigned int end : neighbours)
              result.push_back(
                  make_facet<3>({{corner_alone<3>(corner), corner_alone<3>(end), face_centre}},
                                outward, corner / 2, SubCells<3>::outside, face));
          else
            result.push_back(make_facet<3>({{corner_alone<3>(corner), face_centre, centre}},
                                           unit[neighbours[1]] - unit[neighbours[0]],
                                           neighbours[0] / 2, neighbours[1] / 2, n_faces));
        }
      }
      return result;
    }

    /** Centroids in the unit cell: all simplices of a sub-cell, which the facets of a face make
     * with the centre of the cell, have the same volume there. */
    template <int dim>
    std::array<SharesOf<dim>, SubCells<dim>::n_sub_cells> make_centroids()
    {
      std::array<std::vector<SharesOf<dim>>, SubCells<dim>::n_sub_cells> simplices;
      for (const auto &facet : SubCells<dim>::facets())
        if (facet.to == SubCells<dim>::outside)
        {
          std::vector<SharesOf<dim>> vertices(facet.vertices.begin(), facet.vertices.end());
          vertices.push_back(centre_of_cell<dim>());
          simplices[facet.from].push_back(mean_of<dim>(vertices));
        }
      std::array<SharesOf<dim>, SubCells<dim>::n_sub_cells> result;
      for (unsigned int q = 0; q < result.size(); ++q)
        result[q] = mean_of<dim>(simplices[q]);
      return result;
    }

  } // namespace

  template <int dim>
  const std::vector<typename SubCells<dim>::Facet> &SubCells<dim>::facets()
  {
    static const std::vector<Facet> result = make_facets(std::integral_constant<int, dim>());
    return result;
  }

  // Not inlined, so that round-off does not depend on the sources that are compiled together.
  template <int dim>
  [[gnu::noinline]] Point<dim> SubCells<dim>::point_at(const Shares &shares, const Corners &corners)
  {
    Point<dim> result;
    for (unsigned int corner = 0; corner < n_corners; ++corner)
      result += shares[corner] * corners[corner];
    return result;
  }

  template <int dim>
  [[gnu::noinline]] Tensor<1, dim> SubCells<dim>::area(const Facet &facet, const Corners &corners)
  {
    std::array<Point<dim>, dim> vertices;
    for (unsigned int v = 0; v < dim; ++v)
      vertices[v] = point_at(facet.vertices[v], corners);
    return area_of(vertices, facet.orientation);
  }

  template <int dim>
  const std::array<typename SubCells<dim>::Shares, SubCells<dim>::n_sub_cells> &
  SubCells<dim>::centroids()
  {
    static const auto result = make_centroids<dim>();
    return result;
  }

  template <int dim>
  PointOfCell<dim>::PointOfCell(const typename SubCells<dim>::Corners &corners)
  {
    Point<dim> unit;
    for (unsigned int d = 0; d < dim; ++d)
      unit[d] = 0.5;
    for (unsigned int corner = 0; corner < SubCells<dim>::n_corners; ++corner)
    {
      position += GeometryInfo<dim>::d_linear_shape_function(unit, corner) * corners[corner];
      jacobian += outer_product(Tensor<1, dim>(corners[corner]),
                                GeometryInfo<dim>::d_linear_shape_function_gradient(unit, corner));
    }
  }

  template <int dim>
  std::vector<std::vector<double>> corner_shares_of_points(const SmoothedIntegrationRule rule)
  {
    std::vector<std::vector<double>> result;
    if (rule == SmoothedIntegrationRule::smoothed)
      for (const auto &shares : SubCells<dim>::centroids())
        result.emplace_back(shares.begin(), shares.end());
    else
      result.emplace_back(SubCells<dim>::n_corners, 1. / SubCells<dim>::n_corners);
    return result;
  }

  template class SubCells<2>;
  template class SubCells<3>;
  template struct PointOfCell<2>;
  template struct PointOfCell<3>;
  template std::vector<std::vector<double>> corner_shares_of_points<2>(SmoothedIntegrationRule);
  template std::vector<std::vector<double>> corner_shares_of_points<3>(SmoothedIntegrationRule);
} // namespace tombolo
