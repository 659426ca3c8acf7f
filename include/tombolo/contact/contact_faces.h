// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <tombolo/contact/face_overlap.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The faces of one side of a contact between bodies: outer faces (Nodes::is_outer_face) of cells
   * of degree 1, and those below cells that are gone, each on the rank that owns its cell. Nodes
   * are numbered locally.
   */
  template <int dim>
  class ContactFaces
  {
  public:
    static constexpr unsigned int n_corners = 1u << (dim - 1);
    using Cell = typename Nodes<dim>::Cell;

    struct Face
    {
      std::array<dealii::types::global_dof_index, n_corners> global_nodes;
      std::array<unsigned int, n_corners> nodes; ///< local
      double orientation;                        ///< 1 where area_vector() is out of the body
      double thickness;                          ///< initial volume of the cell over the area [L]
    };

    using Selector = std::function<bool(const Cell &, unsigned int face)>;
    using IsGone = std::function<bool(const Cell &)>; ///< of owned and ghost cells

    /** Takes the faces that @p selects. */
    ContactFaces(const Nodes<dim> &nodes, const Selector &selects, const IsGone &is_gone = {});

    /** Translates node numbers to those of @p partition. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    const std::vector<Face> &faces() const
    {
      return all;
    }

    /** The owned nodes on faces of any rank, ascending. */
    const std::vector<unsigned int> &owned_nodes() const
    {
      return owned;
    }

    FaceCorners<dim> corners(const Face &face, const NodalVector &position) const;

    /** Finds what the faces have at each owned node [L^(dim-1)] in these positions (ghosts
     * current): the norm of the sums of ∫ N |n_d| dA over d, with n_d of one sign. It is at least
     * the area of the faces that a contact can press at the same time. Collective. */
    void find_areas(const NodalVector &position, std::vector<double> &area);

  private:
    std::vector<Face> all;
    std::vector<unsigned int> owned;
    NodalVector positive, negative; // buffers of find_areas()
  };
} // namespace tombolo
