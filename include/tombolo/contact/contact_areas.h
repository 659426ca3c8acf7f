// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/outward_areas.h>

#include <set>
#include <vector>

namespace tombolo
{
  /** The areas on which candidate nodes of a contact touch: what a node has of the outer faces
   * across the normal, and inside of the body, or once it has come off, V^((dim-1)/dim) of its
   * initial volume. */
  template <int dim>
  class ContactAreas
  {
  public:
    /** Of @p candidates (owned nodes), with faces of these ids, or all if there are none; @p volume
     * is the initial one of each owned node. */
    ContactAreas(const Nodes<dim> &nodes, const std::set<dealii::types::boundary_id> &boundaries,
                 const std::vector<unsigned int> &candidates, const std::vector<double> &volume);

    /** Of the faces; the others do not change. */
    OutwardAreas<dim> &of_faces()
    {
      return faces;
    }

    /** Of candidate @p k, the owned node @p node, across @p normal out of the tool [L^(dim-1)]. */
    double area(std::size_t k, unsigned int node, const dealii::Tensor<1, dim> &normal) const
    {
      return faces.has_face(node) ? -(faces.area(node) * normal) : inner_area[k];
    }

  private:
    OutwardAreas<dim> faces;
    std::vector<double> inner_area; ///< of each candidate
  };
} // namespace tombolo
