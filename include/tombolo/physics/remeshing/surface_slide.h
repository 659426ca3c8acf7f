// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/curved_surface.h>
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
   * is neither towards another part nor on a plane of symmetry. It can slide as well where all of
   * the boundary around it is towards void cells.
   */
  template <int dim>
  class SurfaceSlide
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    using CellNodes = std::vector<std::array<unsigned int, n_corners>>;

    /** @p lattice: the cells of the part on this rank, with their initial corners. Collective. */
    SurfaceSlide(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &lattice);

    /** Whether an owned node is on the boundary of the full cells. */
    bool is_on_boundary(const unsigned int node) const
    {
      return n_faces_of_nodes[node] > 0.;
    }

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

    /** The same onto the surface of before of a body of which cells have been filled or emptied
     * since, @p former: as far as cells with a node that is @p near (scalar, with ghosts) bound it.
     * A node without a place there stays where it is. A node goes a share of its way from its place
     * in the mesh, @p way_shares (scalar, owned). In the end the near cells have the volume
     * @p target. Collective. */
    void slide_onto(const SurfaceSlide &former, const NodalVector &near, double target,
                    const CellNodes &nodes, const NodalVector &slides,
                    const NodalVector &way_shares, const NodalVector &initial,
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
    void examine_faces(const std::vector<SmoothedCell<dim>> &lattice, NodalVector &ids,
                       NodalVector &normals) const;

    /** Collective. */
    CurvedSurface<dim> gather_surface(const CellNodes &nodes, const NodalVector &slides,
                                      const NodalVector &position) const;
    /** Unit normals where the body is smooth, with ghosts. Collective. */
    NodalVector normals_of_nodes(const CellNodes &nodes, const NodalVector &position) const;
    /** What slide() and slide_onto() do, to the volume @p target of cells that are near.
     * Collective.
     */
    void move_onto(const CurvedSurface<dim> &surface, double target, const NodalVector &near,
                   const CellNodes &nodes, const NodalVector &slides, const NodalVector *way_shares,
                   const NodalVector &initial, const NodalVector *otherwise,
                   const KeepOutside &keep_outside, NodalVector &position) const;
    /** ∫ N n dA of the boundary, at owned nodes. Collective. */
    NodalVector areas_of_nodes(const CellNodes &nodes, const NodalVector &position) const;
    /** Of the full cells with a node that is near. Collective. */
    double volume(const CellNodes &nodes, const NodalVector &near,
                  const NodalVector &position) const;
    /** Puts sliding nodes onto the surface; a node without a place on the side it is on goes back
     * to @p otherwise, or stays where that is null. Collective. */
    void put_onto(const CurvedSurface<dim> &surface, const CellNodes &nodes,
                  const NodalVector &slides, const NodalVector *otherwise,
                  NodalVector &position) const;
    /** Moves the sliding nodes that are not bound along their normals. Collective. */
    void restore_volume(const CellNodes &nodes, const NodalVector &slides, const NodalVector &near,
                        const NodalVector &is_bound, double target, NodalVector &position) const;

    MPI_Comm communicator;
    std::vector<bool> is_smooth;          ///< of owned nodes
    std::vector<double> n_faces_of_nodes; ///< of owned nodes
    std::vector<bool> is_void;            ///< of cells
    /** Which facets of SubCells of each cell bound the part. */
    std::vector<std::vector<unsigned int>> facets_of_cells;
    /** ∫ ∇N·∇N over the boundary faces of each cell, along the faces, initially. */
    std::vector<std::array<double, n_corners * n_corners>> membranes;
  };
} // namespace tombolo
