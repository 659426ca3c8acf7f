// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_faces.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using PlanePoint = Tensor<1, 2>;
    using PlaneQuadrilateral = std::array<PlanePoint, 4>;

    /** A polygon of at most as many corners as the clipping of two quadrilaterals can have. */
    struct Polygon
    {
      std::array<PlanePoint, 16> corners;
      unsigned int size = 0;

      void add(const PlanePoint &corner)
      {
        if (size < corners.size())
          corners[size++] = corner;
      }
    };

    /** The rule of degree 4 (Dunavant, Int. J. Numer. Meth. Eng. 21, 1985): weight and barycentric
     * coordinate, which two corners have, of three points each. Products of two bilinear functions
     * have this degree where faces are parallelograms: then weights do not jump where faces slide
     * over each other and the polygon gets another corner. */
    constexpr std::array<std::pair<double, double>, 2> rule_of_triangles{
        {{0.22338158967801146570, 0.44594849091596488632},
         {0.10995174365532186764, 0.09157621350977074346}}};

    double cross(const PlanePoint &a, const PlanePoint &b)
    {
      return a[0] * b[1] - a[1] * b[0];
    }

    double double_area(const Polygon &polygon)
    {
      double sum = 0;
      for (unsigned int k = 1; k + 1 < polygon.size; ++k)
        sum += cross(polygon.corners[k] - polygon.corners[0],
                     polygon.corners[k + 1] - polygon.corners[0]);
      return sum;
    }

    /** The centre of the area: corners that fall on each other, as where a corner is clipped at an
     * edge of its own, do not move it. */
    PlanePoint centre_of(const Polygon &polygon)
    {
      PlanePoint sum;
      double area = 0;
      const PlanePoint &start = polygon.corners[0];
      for (unsigned int k = 1; k + 1 < polygon.size; ++k)
      {
        const PlanePoint one = polygon.corners[k] - start, other = polygon.corners[k + 1] - start;
        area += cross(one, other);
        sum += cross(one, other) / 3. * (one + other);
      }
      return start + sum / area;
    }

    /** The corners of a quadrilateral counter-clockwise. */
    Polygon polygon_of(const PlaneQuadrilateral &face)
    {
      Polygon result;
      for (const unsigned int k : {0u, 1u, 3u, 2u})
        result.add(face[k]);
      if (double_area(result) < 0.)
        std::swap(result.corners[1], result.corners[3]);
      return result;
    }

    /** What of @p subject is left of the line from @p begin to @p end. */
    Polygon clip(const Polygon &subject, const PlanePoint &begin, const PlanePoint &end)
    {
      Polygon result;
      for (unsigned int k = 0; k < subject.size; ++k)
      {
        const PlanePoint &corner = subject.corners[k];
        const PlanePoint &next = subject.corners[(k + 1) % subject.size];
        const double of_corner = cross(end - begin, corner - begin);
        const double of_next = cross(end - begin, next - begin);
        if (of_corner >= 0.)
          result.add(corner);
        if ((of_corner >= 0.) != (of_next >= 0.))
          result.add(corner + of_corner / (of_corner - of_next) * (next - corner));
      }
      return result;
    }

    std::array<double, 4> bilinear(const double xi, const double eta)
    {
      return {{(1. - xi) * (1. - eta), xi * (1. - eta), (1. - xi) * eta, xi * eta}};
    }

    /** The shape functions of a quadrilateral at a point of the plane, by Newton's method. */
    std::array<double, 4> shapes_at(const PlaneQuadrilateral &face, const PlanePoint &point)
    {
      const PlanePoint along = face[1] - face[0], up = face[2] - face[0];
      const PlanePoint twist = face[3] - face[2] - along;
      double xi = 0.5, eta = 0.5;
      constexpr unsigned int most_iterations = 20;
      for (unsigned int i = 0; i < most_iterations; ++i)
      {
        const PlanePoint rest = point - face[0] - xi * along - eta * up - xi * eta * twist;
        const PlanePoint by_xi = along + eta * twist, by_eta = up + xi * twist;
        const double determinant = cross(by_xi, by_eta);
        if (determinant == 0.)
          break;
        const double change_xi = cross(rest, by_eta) / determinant;
        const double change_eta = cross(by_xi, rest) / determinant;
        xi += change_xi;
        eta += change_eta;
        if (std::abs(change_xi) + std::abs(change_eta) < 1e-14)
          break;
      }
      return bilinear(xi, eta);
    }
  } // namespace

  void find_overlap(const FaceCorners<3> &slave, const FaceCorners<3> &master,
                    std::vector<OverlapPoint<3>> &points)
  {
    points.clear();
    const Tensor<1, 3> normal = area_vector<3>(slave);
    Tensor<1, 3> centre;
    for (const auto &corner : slave)
      centre += 0.25 * corner;
    Tensor<1, 3> first = slave[1] - slave[0] + slave[3] - slave[2];
    first -= (first * normal) / normal.norm_square() * normal;
    first /= first.norm();
    const Tensor<1, 3> second = cross_product_3d(normal / normal.norm(), first);
    PlaneQuadrilateral slave_face, master_face;
    for (unsigned int k = 0; k < 4; ++k)
    {
      slave_face[k] = PlanePoint({(slave[k] - centre) * first, (slave[k] - centre) * second});
      master_face[k] = PlanePoint({(master[k] - centre) * first, (master[k] - centre) * second});
    }
    const Polygon frame = polygon_of(slave_face);
    Polygon common = polygon_of(master_face);
    for (unsigned int k = 0; k < 4 && common.size > 2; ++k)
      common = clip(common, frame.corners[k], frame.corners[(k + 1) % 4]);
    constexpr double nothing = 1e-12; // of the area of the slave face
    if (common.size < 3 || double_area(common) < nothing * double_area(frame))
      return;
    // From a corner that geometry chooses, since only for parallelograms the rule is exact.
    const PlanePoint middle = centre_of(common);
    unsigned int first_corner = 0;
    for (unsigned int k = 1; k < common.size; ++k)
      if ((common.corners[k] - middle).norm() > (common.corners[first_corner] - middle).norm())
        first_corner = k;
    const auto corner = [&](const unsigned int k)
    { return common.corners[(first_corner + k) % common.size]; };
    for (unsigned int k = 1; k + 1 < common.size; ++k)
    {
      const std::array<PlanePoint, 3> corners{{corner(0), corner(k), corner(k + 1)}};
      const double area = 0.5 * cross(corners[1] - corners[0], corners[2] - corners[0]);
      if (!(area > 0.))
        continue;
      for (const auto &[weight, place] : rule_of_triangles)
        for (unsigned int q = 0; q < 3; ++q)
        {
          const PlanePoint point =
              place * (corners[0] + corners[1] + corners[2]) + (1. - 3. * place) * corners[q];
          points.push_back(
              {weight * area, shapes_at(slave_face, point), shapes_at(master_face, point)});
        }
    }
  }

  void find_overlap(const FaceCorners<2> &slave, const FaceCorners<2> &master,
                    std::vector<OverlapPoint<2>> &points)
  {
    points.clear();
    const Tensor<1, 2> along = slave[1] - slave[0];
    const double length = along.norm();
    const Tensor<1, 2> direction = along / length;
    const double begin = (master[0] - slave[0]) * direction;
    const double end = (master[1] - slave[0]) * direction;
    const double low = std::max(0., std::min(begin, end));
    const double high = std::min(length, std::max(begin, end));
    constexpr double nothing = 1e-12; // of the length of the slave face
    if (high - low < nothing * length)
      return;
    const double half_width = 0.5 / std::sqrt(3.); // of the Gauss points, in the unit interval
    for (const double place : {0.5 - half_width, 0.5 + half_width})
    {
      const double s = low + place * (high - low);
      const double of_slave = s / length, of_master = (s - begin) / (end - begin);
      points.push_back(
          {0.5 * (high - low), {{1. - of_slave, of_slave}}, {{1. - of_master, of_master}}});
    }
  }

  template <int dim>
  ContactFaces<dim>::ContactFaces(const Nodes<dim> &nodes, const Selector &selects,
                                  const IsGone &is_gone)
  {
    const auto is_exposed = [&](const Cell &cell, const unsigned int f)
    { return is_gone && !cell->at_boundary(f) && is_gone(cell->neighbor(f)); };
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (!cell->is_locally_owned() || (is_gone ? is_gone(cell) : !cell->at_boundary()))
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, points);
      for (const unsigned int f : cell->face_indices())
      {
        if (!(nodes.is_outer_face(cell, f) || is_exposed(cell, f)) || !selects(cell, f))
          continue;
        const std::vector<unsigned int> &places = nodes.face_places(f);
        Face face;
        FaceCorners<dim> corners;
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          face.global_nodes[k] = cell_nodes[places[k]];
          corners[k] = points[places[k]];
        }
        const Tensor<1, dim> area = area_vector<dim>(corners);
        face.orientation = area * (cell->face(f)->center() - cell->center()) > 0. ? 1. : -1.;
        face.thickness = cell->measure() / area.norm();
        all.push_back(face);
      }
    }
  }

  template <int dim>
  void ContactFaces<dim>::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    positive.reinit(partition, Quantity::scalars);
    negative.reinit(partition, Quantity::scalars);
    for (Face &face : all)
      for (unsigned int k = 0; k < n_corners; ++k)
        face.nodes[k] = partition->local_index(face.global_nodes[k]);
    owned = owned_marked_nodes(partition,
                               [&](const auto &mark)
                               {
                                 for (const Face &face : all)
                                   std::for_each(face.nodes.begin(), face.nodes.end(), mark);
                               });
  }

  template <int dim>
  FaceCorners<dim> ContactFaces<dim>::corners(const Face &face, const NodalVector &position) const
  {
    FaceCorners<dim> result;
    for (unsigned int k = 0; k < n_corners; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        result[k][d] = position.node(face.nodes[k])[d];
    return result;
  }

  template <int dim>
  void ContactFaces<dim>::find_areas(const NodalVector &position, std::vector<double> &area)
  {
    for (const unsigned int node : owned)
    {
      std::fill_n(positive.node(node), node_stride, 0.);
      std::fill_n(negative.node(node), node_stride, 0.);
    }
    for (const Face &face : all)
    {
      const Tensor<1, dim> share =
          face.orientation / n_corners * area_vector<dim>(corners(face, position));
      for (const unsigned int node : face.nodes)
        for (unsigned int d = 0; d < dim; ++d)
          (share[d] > 0. ? positive : negative).node(node)[d] += std::abs(share[d]);
    }
    positive.add_to_owners();
    negative.add_to_owners();
    area.clear();
    for (const unsigned int node : owned)
    {
      double square = 0;
      for (unsigned int d = 0; d < dim; ++d)
        square += std::pow(std::max(positive.node(node)[d], negative.node(node)[d]), 2);
      area.push_back(std::sqrt(square));
    }
  }

  template class ContactFaces<2>;
  template class ContactFaces<3>;
} // namespace tombolo
