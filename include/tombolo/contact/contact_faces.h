// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  /** Corners of a face of a cell of degree 1, in lexicographic order. */
  template <int dim>
  using FaceCorners = std::array<dealii::Tensor<1, dim>, (1u << (dim - 1))>;

  /** The area of a face with its direction, ∫ n dA [L^(dim-1)]: that of the product of the
   * tangents, as FaceShapes::normal() has it. */
  template <int dim>
  dealii::Tensor<1, dim> area_vector(const FaceCorners<dim> &face)
  {
    if constexpr (dim == 2)
      return dealii::cross_product_2d(face[1] - face[0]);
    else
      return 0.5 * dealii::cross_product_3d(face[3] - face[0], face[2] - face[1]);
  }

  /** A point of the common part of two faces. */
  template <int dim>
  struct OverlapPoint
  {
    double weight;                                  ///< of the quadrature [L^(dim-1)]
    std::array<double, (1u << (dim - 1))> of_slave; ///< N of the slave face
    std::array<double, (1u << (dim - 1))> of_master;
  };

  /**
   * The common part of a slave face and a master face, both projected onto the plane through the
   * centre of the slave face with the direction of its area (in two dimensions onto a line). The
   * projected master face is clipped by the edges of the slave face (Sutherland and Hodgman), the
   * polygon divided into triangles from its corner farthest from the centre of its area, and each
   * gets 6 points of the rule of degree 4, so that the numbering of corners does not matter, and
   * weights are exact where both faces are parallelograms; in two dimensions an interval
   * gets 2 Gauss points. Both faces have their shape functions at the same
   * points, so that Σ_J w^s_IJ = Σ_L w^m_IL for the weights of a mortar. Weights are areas on the
   * plane.
   *
   * The slave face must be convex on the plane. Replaces @p points; none where the projections do
   * not overlap.
   */
  void find_overlap(const FaceCorners<2> &slave, const FaceCorners<2> &master,
                    std::vector<OverlapPoint<2>> &points);
  void find_overlap(const FaceCorners<3> &slave, const FaceCorners<3> &master,
                    std::vector<OverlapPoint<3>> &points);

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
