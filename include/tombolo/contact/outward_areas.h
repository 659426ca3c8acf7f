// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/mesh/face_shapes.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <vector>

namespace tombolo
{
  /**
   * The areas of nodes on the boundary of the mesh with their directions: S_k = ∫ N_k n dA over
   * outer faces (Nodes::is_outer_face), n out of the body, in given positions. The area of a node
   * at an edge of the body on one of its sides is the part of S_k along the normal of that side.
   */
  template <int dim>
  class OutwardAreas
  {
  public:
    /** Selects the faces with these ids, or all if there are none. */
    OutwardAreas(const Nodes<dim> &nodes, const std::set<dealii::types::boundary_id> &boundaries)
        : boundaries(boundaries), shapes(nodes.degree(), nodes.degree() + 1)
    {
      select_faces(nodes, [](const auto &) { return false; });
    }

    using IsVoid = std::function<bool(const typename Nodes<dim>::Cell &)>;

    /** Selects the faces that bound the cells that are not void; towards void cells only if there
     * are no ids. set_partition() must follow. */
    void select_faces(const Nodes<dim> &nodes, const IsVoid &is_void)
    {
      faces.clear();
      const auto is_outside = [&](const auto &cell, const unsigned int face)
      {
        if (cell->at_boundary(face))
          return nodes.is_outer_face(cell, face) &&
                 (boundaries.empty() || boundaries.count(cell->face(face)->boundary_id()) > 0);
        return boundaries.empty() && cell->neighbor(face)->is_active() &&
               is_void(cell->neighbor(face));
      };
      nodes.for_each_face(
          [&](const auto &cell, const unsigned int f)
          { return is_outside(cell, f) && !is_void(cell); },
          [&](const auto &cell, const unsigned int f, const auto &face_nodes,
              const auto &face_points)
          {
            dealii::Tensor<1, dim> normal;
            for (unsigned int q = 0; q < shapes.weights.size(); ++q)
              normal += shapes.weights[q] *
                        shapes.normal(q, [&](const unsigned int k) { return face_points[k]; });
            const dealii::Tensor<1, dim> outward = cell->face(f)->center() - cell->center();
            faces.push_back({face_nodes, {}, normal * outward > 0. ? 1. : -1.});
          });
    }

    /** Translates node numbers to those of @p partition, and forgets isolated nodes. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      sums.reinit(partition);
      for (Face &face : faces)
      {
        face.counts = true;
        face.nodes.clear();
        for (const dealii::types::global_dof_index node : face.global_nodes)
          face.nodes.push_back(partition->local_index(node));
      }
      find_nodes_on_faces();
    }

    /** Faces with one of these owned nodes, all that are separated, count no more. Collective. */
    void set_isolated_nodes(const std::vector<unsigned int> &nodes)
    {
      const NodalVector isolated =
          marked_nodes(sums.partition(),
                       [&](const auto &mark) { std::for_each(nodes.begin(), nodes.end(), mark); });
      for (Face &face : faces)
        face.counts =
            std::none_of(face.nodes.begin(), face.nodes.end(),
                         [&](const unsigned int node) { return *isolated.node(node) > 0.; });
      find_nodes_on_faces();
    }

    /** Finds the areas in these positions (ghosts current), or of owned @p nodes. Collective. */
    void update(const NodalVector &position, const std::vector<unsigned int> *const nodes = nullptr)
    {
      // The owner determines whether a ghost is needed.
      is_needed.assign(position.partition()->n_local(), 1);
      std::fill_n(is_needed.begin(), nodes == nullptr ? 0 : position.partition()->n_owned(), 0);
      for (std::size_t k = 0; nodes != nullptr && k < nodes->size(); ++k)
        is_needed[(*nodes)[k]] = 1;
      const auto add = [&](const Face &face, const unsigned int q)
      {
        const dealii::Tensor<1, dim> normal =
            shapes.normal(q, [&](const unsigned int k) { return position.node(face.nodes[k]); });
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            sums.node(face.nodes[k])[d] +=
                face.orientation * shapes.weights[q] * shapes.value(q, k) * normal[d];
      };
      add_up({&sums},
             [&]
             {
               for (const Face &face : faces)
               {
                 if (!face.counts ||
                     std::none_of(face.nodes.begin(), face.nodes.end(),
                                  [&](const unsigned int node) { return is_needed[node] != 0; }))
                   continue;
                 if (dim == 3 && shapes.n_nodes == 4)
                   add_bilinear(position, face.nodes, face.orientation, sums);
                 else
                   for (unsigned int q = 0; q < shapes.weights.size(); ++q)
                     add(face, q);
               }
             });
    }

    /** S of an owned node [L^(dim-1)]. */
    dealii::Tensor<1, dim> area(const unsigned int node) const
    {
      return vector_of<dim>(sums.node(node));
    }

    /** Whether an owned node is on any of the faces that count, of any rank. */
    bool has_face(const unsigned int node) const
    {
      return is_on_face[node];
    }

  private:
    /** Adds ∫ N_k n dA of a bilinear face to the sums of its four @p nodes, times @p orientation:
     * with x = m + ξ a + η b + ξη c its normal is a × b + ξ a × c + η c × b. */
    static void add_bilinear(const NodalVector &position, const std::vector<unsigned int> &nodes,
                             const double orientation, NodalVector &sums)
    {
      NodeLanes x[4];
      for (unsigned int k = 0; k < 4; ++k)
        x[k] = load_node(position.node(nodes[k]));
      const NodeLanes a = 0.25 * ((x[1] - x[0]) + (x[3] - x[2])),
                      b = 0.25 * ((x[2] - x[0]) + (x[3] - x[1])),
                      c = 0.25 * ((x[0] - x[1]) + (x[3] - x[2]));
      const NodeLanes mean = orientation * cross_product(a, b),
                      along_first = (orientation / 3.) * cross_product(a, c),
                      along_second = (orientation / 3.) * cross_product(c, b);
      for (unsigned int k = 0; k < 4; ++k)
      {
        double *const sum = sums.node(nodes[k]);
        store_node(load_node(sum) + mean + (k % 2 == 1 ? along_first : -along_first) +
                       (k / 2 == 1 ? along_second : -along_second),
                   sum);
      }
    }

    void find_nodes_on_faces()
    {
      is_on_face.assign(sums.partition()->n_owned(), false);
      for (const unsigned int node : owned_marked_nodes(sums.partition(),
                                                        [&](const auto &mark)
                                                        {
                                                          for (const Face &face : faces)
                                                            if (face.counts)
                                                              std::for_each(face.nodes.begin(),
                                                                            face.nodes.end(), mark);
                                                        }))
        is_on_face[node] = true;
    }

    struct Face
    {
      std::vector<dealii::types::global_dof_index> global_nodes;
      std::vector<unsigned int> nodes; ///< local
      double orientation;              ///< 1 where the normal of the tangents is out of the body
      bool counts = true;              ///< whether no node of it is isolated
    };

    std::set<dealii::types::boundary_id> boundaries;
    std::vector<Face> faces;
    FaceShapes<dim> shapes;
    NodalVector sums;
    std::vector<bool> is_on_face; ///< of owned nodes
    /** Buffer of update(): whether the areas of local nodes are needed. */
    std::vector<std::uint8_t> is_needed;
  };

  extern template class OutwardAreas<2>;
  extern template class OutwardAreas<3>;
} // namespace tombolo
