// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_tree.h>
#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/model/model.h>
#include <tombolo/remesh/cell_matrices.h>

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * Nodes on the boundary of a part that slide on its surface, so that a refill can space them as
   * in the lattice of the start: sweeps let their displacements from the lattice relax towards
   * those of their neighbours on the surface, and put them back onto the surface that was there
   * before. That is curved between its nodes, by half of the way to their tangent planes, so that
   * nodes on a round tool stay on it. In the end they all move by one distance along their normals,
   * with which the volume is that of before.
   *
   * A node can slide where the boundary around it is smooth at the start, has one boundary id, and
   * is neither towards another part nor on a plane of symmetry.
   */
  template <int dim>
  class SurfaceSlide
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    using CellNodes = std::vector<std::array<unsigned int, n_corners>>;

    /** @p lattice: the cells of the part on this rank, initially. Collective. */
    SurfaceSlide(const Model<dim> &model, unsigned int part,
                 const std::vector<SmoothedCell<dim>> &lattice);

    /** Of an owned node. */
    bool can_slide(const unsigned int node) const
    {
      return is_smooth[node];
    }

    using KeepOutside = std::function<void(NodalVector &position, NodalVector &is_bound)>;
    using FindDepths =
        std::function<void(const NodalVector &places, const std::vector<unsigned int> &numbers,
                           std::vector<double> &depths)>;

    /** What a node does that slides: it relaxes towards its place in the mesh, or it is put onto
     * the surface as it comes. */
    static constexpr double relaxes = 1., goes_with_mesh = 0.5;

    /**
     * Moves the nodes of which @p slides (scalar, owned: relaxes, goes_with_mesh or zero) is
     * positive. @p nodes: local numbers of the corners of the cells; @p initial: places in the
     * mesh, @p before: positions, with ghosts. @p keep_outside corrects the positions of owned
     * nodes and marks those that stay as they are then. @p position: where sliding nodes start,
     * and the positions of before of others; gets the new ones, with ghosts. Collective.
     */
    void slide(const CellNodes &nodes, const NodalVector &slides, const NodalVector &initial,
               const NodalVector &before, const KeepOutside &keep_outside,
               NodalVector &position) const;

    /** Scalar, with ghosts: positive at sliding nodes whose faces would be cut by a surface that
     * did not cut them before, as by the edge of a tool; a tool that has moved with the mesh may
     * cut them deeper by its @p way [L]. @p find_depths gives how deep places are. Nothing if there
     * is none. Collective. */
    std::optional<NodalVector> nodes_of_cut_faces(const CellNodes &nodes, const NodalVector &slides,
                                                  const NodalVector &before,
                                                  const NodalVector &after, double way,
                                                  const FindDepths &find_depths) const;

  private:
    using Corners = typename SubCells<dim>::Corners;

    /** Adds what the boundary faces of the part say of their nodes. */
    void examine_faces(const Model<dim> &model, unsigned int part,
                       const std::vector<SmoothedCell<dim>> &lattice, NodalVector &ids,
                       NodalVector &normals) const;

    static constexpr unsigned int n_face_nodes = dealii::GeometryInfo<dim>::vertices_per_face;

    /** The boundary near sliding nodes, of all ranks. */
    struct Surface
    {
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

      /** Adds what a rank has sent. */
      void add(const std::vector<double> &of_rank);
      /** The place on the curved surface over a place of a facet. */
      dealii::Tensor<1, dim> raise(const dealii::Tensor<1, dim> &place, unsigned int facet) const;
    };
    /** Collective. */
    Surface gather_surface(const CellNodes &nodes, const NodalVector &slides,
                           const NodalVector &position) const;
    /** Unit normals where the body is smooth, with ghosts. Collective. */
    NodalVector normals_of_nodes(const CellNodes &nodes, const NodalVector &position) const;
    /** ∫ N n dA of the boundary, at owned nodes. Collective. */
    NodalVector areas_of_nodes(const CellNodes &nodes, const NodalVector &position) const;
    /** Of the cells with a node that slides. Collective. */
    double volume(const CellNodes &nodes, const NodalVector &slides,
                  const NodalVector &position) const;
    /** Puts sliding nodes onto the surface; a node without a place on the side it is on goes back
     * to @p before. Collective. */
    void put_onto(const Surface &surface, const CellNodes &nodes, const NodalVector &slides,
                  const NodalVector &before, NodalVector &position) const;
    /** Moves the sliding nodes that are not bound along their normals. Collective. */
    void restore_volume(const CellNodes &nodes, const NodalVector &slides,
                        const NodalVector &is_bound, double target, NodalVector &position) const;

    MPI_Comm communicator;
    std::vector<bool> is_smooth; ///< of owned nodes
    /** Which facets of SubCells of each cell bound the part. */
    std::vector<std::vector<unsigned int>> facets_of_cells;
    /** ∫ ∇N·∇N over the boundary faces of each cell, along the faces, initially. */
    std::vector<std::array<double, n_corners * n_corners>> membranes;
  };
} // namespace tombolo
