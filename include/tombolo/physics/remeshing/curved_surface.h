// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_tree.h>

#include <deal.II/base/geometry_info.h>

#include <array>
#include <optional>
#include <vector>

namespace tombolo
{
  /** A piece of the boundary of a part, of all ranks: facets that are curved between the nodes of
   * their faces. Where several places are equally near, one direction decides, and no round-off. */
  template <int dim>
  struct CurvedSurface
  {
    using Nearest = typename FacetTree<dim>::Nearest;

    static constexpr unsigned int n_face_nodes = dealii::GeometryInfo<dim>::vertices_per_face;

    /** The nodes of a face of the boundary, and the normals there; zero at edges of the body. */
    struct Face
    {
      std::array<dealii::Tensor<1, dim>, n_face_nodes> places, normals;
    };

    ClosedSurface<dim> facets;
    FacetTree<dim> tree;
    std::vector<Face> faces; ///< of each facet
    /** Of the vertices of each facet, in the places of the nodes of its face. */
    std::vector<std::array<std::array<double, n_face_nodes>, dim>> shares;

    /** Adds what a rank has sent: of each facet its vertices, its normal, the shares, and the
     * places and normals of its face. */
    void add(const std::vector<double> &of_rank);

    /** All facets were added. */
    void complete();

    /** See FacetTree. */
    Nearest nearest(const dealii::Tensor<1, dim> &point) const;
    std::optional<Nearest> nearest_facing(const dealii::Tensor<1, dim> &point,
                                          const dealii::Tensor<1, dim> &direction,
                                          double limit) const;

    /** The place on the curved surface over a place of a facet: half of the way to the tangent
     * planes at the nodes of the face. */
    dealii::Tensor<1, dim> raise(const dealii::Tensor<1, dim> &place, unsigned int facet) const;

    /** The node next to a place, of the face of a facet. */
    const dealii::Tensor<1, dim> &node_near(const dealii::Tensor<1, dim> &place,
                                            unsigned int facet) const;

    dealii::Tensor<1, dim> aside; ///< a small way, by which ties are decided [L]
  };
} // namespace tombolo
