// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/model/model.h>
#include <tombolo/remesh/cell_matrices.h>

#include <deal.II/base/geometry_info.h>

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace tombolo
{
  template <int dim>
  struct CurvedSurface;

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

    /** @p lattice: the cells of the part on this rank, with their initial corners; @p nodes: the
     * local numbers of these, which must be current in all calls. Collective. */
    SurfaceSlide(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &lattice,
                 const CellNodes &nodes);

    /** Whether an owned node is on the boundary of the full cells. */
    bool is_on_boundary(const unsigned int node) const
    {
      return boundary_nodes[node];
    }

    /** Of an owned node: whether it can slide. */
    bool is_smooth(const unsigned int node) const
    {
      return smooth_nodes[node];
    }

    /** @p from: where nodes were, or the node next to where they are on the surface of before. */
    using KeepOutside =
        std::function<void(const NodalVector &from, NodalVector &position, NodalVector &is_bound)>;
    /** The volume that is missing at owned nodes [L^dim], in a scalar vector, of those that are not
     * bound (scalar, owned). Collective. */
    using FindMissing =
        std::function<NodalVector(const NodalVector &position, const NodalVector &is_bound)>;
    using FindDepths =
        std::function<void(const NodalVector &places, const std::vector<unsigned int> &numbers,
                           std::vector<double> &depths)>;

    /** What a node does that slides: it relaxes towards its place in the mesh, or it is put onto
     * the surface as it comes. */
    static constexpr double relaxes = 1., goes_with_mesh = 0.5;

    /**
     * Moves the nodes of which @p slides (scalar, owned: relaxes, goes_with_mesh or zero) is
     * positive. @p initial: places in the mesh, @p before: positions, with ghosts. @p keep_outside
     * corrects the positions of owned nodes and marks those that stay as they are then.
     * @p position: where sliding nodes start, and the positions of before of others; gets the new
     * ones, with ghosts. Collective.
     */
    void slide(const NodalVector &slides, const NodalVector &initial, const NodalVector &before,
               const KeepOutside &keep_outside, NodalVector &position) const;

    /** The same onto the surface of before of a body of which cells have been filled or emptied
     * since, @p former: as far as cells with a node that is @p near (scalar, with ghosts) bound it.
     * A node without a place there stays where it is. A node goes a share of its way from its place
     * in the mesh, @p way_shares (scalar, owned). Then it moves along its normal by what is
     * @p missing at it, and in the end the near cells have the volume @p target. Collective. */
    void slide_onto(const SurfaceSlide &former, const NodalVector &near, double target,
                    const NodalVector &slides, const NodalVector &way_shares,
                    const NodalVector &initial, const NodalVector &before,
                    const KeepOutside &keep_outside, const FindMissing &missing,
                    NodalVector &position) const;

    /** Scalar, with ghosts: positive at sliding nodes whose faces would be cut by a surface that
     * did not cut them before, as by the edge of a tool; a tool that has moved with the mesh may
     * cut them deeper by its @p way [L]. @p find_depths gives how deep places are. Nothing if there
     * is none. Collective. */
    std::optional<NodalVector> nodes_of_cut_faces(const NodalVector &slides,
                                                  const NodalVector &before,
                                                  const NodalVector &after, double way,
                                                  const FindDepths &find_depths) const;

  private:
    using Corners = typename SubCells<dim>::Corners;

    /** Finds what the boundary is like around nodes. Collective. */
    void examine_nodes(const NodePartition &partition,
                       const std::vector<SmoothedCell<dim>> &lattice);
    /** Of the cells with a node that slides. Collective. */
    CurvedSurface<dim> gather_surface(const NodalVector &slides, const NodalVector &position) const;
    /** Lets nodes relax towards their places in the mesh, and puts them onto the surface; where
     * there is no place on the side that they are on, to where they were @p otherwise, if that is
     * given. Collective. */
    void relax_onto(const CurvedSurface<dim> &surface, const NodalVector &slides,
                    const NodalVector &initial, const NodalVector *otherwise,
                    NodalVector &position) const;
    /** Moves nodes that are not bound along their normals until the near cells have the volume
     * @p target. Collective. */
    void restore_volume(const NodalVector &slides, const NodalVector &near, const NodalVector &from,
                        const KeepOutside &keep_outside, double target,
                        NodalVector &position) const;
    /** Moves nodes that are not bound along their normals, so that each takes the volume that is
     * missing at it, as far as a quarter of the size of a face. Collective. */
    void restore_missing(const NodalVector &slides, const NodalVector &is_bound,
                         const NodalVector &missing, NodalVector &position) const;
    /** ∫ N n dA of the boundary, at owned nodes. Collective. */
    NodalVector areas_of_nodes(const NodalVector &position) const;
    /** Of the full cells with a node that is near. Collective. */
    double volume(const NodalVector &near, const NodalVector &position) const;

    MPI_Comm communicator;
    const CellNodes &nodes;
    std::vector<bool> is_void;                      ///< of cells
    std::vector<bool> boundary_nodes, smooth_nodes; ///< of owned nodes
    /** Which facets of SubCells of each cell bound the part. */
    std::vector<std::vector<unsigned int>> facets_of_cells;
    /** ∫ ∇N·∇N over the boundary faces of each cell, along the faces, initially. */
    std::vector<std::array<double, n_corners * n_corners>> membranes;
  };
} // namespace tombolo
