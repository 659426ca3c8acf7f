// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_faces.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

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
