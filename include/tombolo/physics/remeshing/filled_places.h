// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/cell_filling.h>
#include <tombolo/physics/remeshing/lattice_motion.h>
#include <tombolo/physics/remeshing/surface_slide.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * Where a refill that fills and empties cells places the nodes of a part with void cells: cells
   * of the mesh are full where the body has at least half of them (CellFilling). Nodes on the
   * surface of these go from their places in the mesh to the surface of before (SurfaceSlide),
   * inner nodes follow, and nodes of void cells alone are at their places in the mesh. Where a cell
   * would become too thin, nodes of the surface go a part of this way only, and in the end stay
   * where they were, as cells around them stay full or void.
   */
  template <int dim>
  class FilledPlaces
  {
  public:
    using Corners = typename SubCells<dim>::Corners;
    using CellNodes = std::vector<std::array<unsigned int, SubCells<dim>::n_corners>>;

    /** @p nodes: local numbers of the corners of the cells, which must be current in all calls.
     * Collective. */
    FilledPlaces(const Model<dim> &model, unsigned int part, const SmoothedCells<dim> &of_part,
                 const CellNodes &nodes);

    /** Adds the full cells next to void ones whose surface has moved by three tenths of their size
     * from where its last refill has put it, @p settled (owned positions). Collective. */
    void add_cells_at_void(const Model<dim> &model, const NodalVector &settled,
                           std::vector<unsigned int> &distorted) const;

    /** Adds the full cells of which a node is farther than half of their size from its place in
     * the mesh, so that nodes that stay are near to theirs; not those whose nodes always stay.
     * Collective. */
    void add_displaced_cells(const Model<dim> &model, const Clock &clock,
                             const LatticeMotion<dim> &motion,
                             std::vector<unsigned int> &distorted) const;

    /** The places of all nodes; only those that @p in_patch marks (scalar, with ghosts) move, and
     * not those of cells beside cells of another size. @p volumes: what the material of each cell
     * takes [L^dim]; cells that move keep the sum. Collective. */
    NodalVector find(const Model<dim> &model, const Clock &clock, const LatticeMotion<dim> &motion,
                     const NodalVector &in_patch, const std::vector<double> &volumes);

    /** Which cells of this rank are void then. */
    const std::vector<bool> &next_void() const
    {
      return void_after;
    }

    /** The place of a cell that was void at the start and cannot be filled, at the end of the mesh
     * or beside cells of another size, and of which the body had half at the last search, the same
     * on all ranks; nothing where there is none. Collective.
     */
    std::optional<dealii::Point<dim>> reached_end(MPI_Comm communicator) const;

    /** Takes the void cells of the part as they are now. Collective. */
    void take_void_cells(const Model<dim> &model);

    /** Scalar, with ghosts: positive at the nodes of cells at the surface, and of those next to
     * them. Collective. */
    NodalVector nodes_near_surface(const Model<dim> &model) const;

  private:
    /** What a search for places knows. */
    struct Search
    {
      NodalVector mesh_places, in_patch, held; ///< nodes that stay (scalar, with ghosts)
      NodalVector way_shares;                  ///< scalar, owned
      NodalVector inside, on_surface;          ///< nodes that move (scalar)
      double volume = 0;                       ///< of cells with a node in the patch
      std::vector<Corners> mesh;               ///< corners of the cells there
      std::vector<bool> near;                  ///< cells with a node in the patch
      std::vector<bool> at_surface;            ///< those of them that can be filled or emptied
    };
    Search begin_search(const Model<dim> &model, const Clock &clock,
                        const LatticeMotion<dim> &motion, const NodalVector &in_patch,
                        const std::vector<double> &volumes);
    /** What the body had of void cells and has not at these places, at those nodes of the cell on
     * the surface that are not bound, and near them. Collective. */
    NodalVector missing(const NodalVector &position, const NodalVector &is_bound,
                        const Search &search) const;
    /** Lets values of nodes that move (one, zero for others; with ghosts) go over to those of the
     * same cells, some times: the sum stays, and what alternates between nodes is gone. Collective.
     */
    NodalVector spread(const NodalVector &moves, NodalVector values) const;
    /** Chooses full cells, and moves the nodes as far as they go. Collective. */
    NodalVector try_places(const Model<dim> &model, const Clock &clock, Search &search);
    /** Marks what nodes do that are not held. Collective. */
    void classify_nodes(const SurfaceSlide<dim> &next, Search &search) const;
    /** Which cells would be too thin; nothing if none would on any rank. Collective. */
    std::optional<std::vector<bool>> thin_cells(const NodalVector &before, const NodalVector &after,
                                                const Search &search) const;
    bool is_thin(std::size_t cell, const Corners &corners, bool is_at_surface) const;
    /** Empties thin cells, or lets their nodes go less far, or stay. Collective. */
    void mend(const std::vector<bool> &is_thin, Search &search);
    void find_end_of_void(const Model<dim> &model);
    /** The cells that can be filled or emptied. */
    std::vector<bool> changeable_cells(const Search &search) const;
    /** The cells of the part with these void ones. Collective. */
    std::vector<SmoothedCell<dim>> cells_with(const Model<dim> &model,
                                              const std::vector<bool> &is_void) const;

    const VoidCells<dim> &voids;
    const CellNodes &local_nodes;
    unsigned int part;
    std::vector<SmoothedCell<dim>> cells;
    std::unique_ptr<SurfaceSlide<dim>> surface;
    std::unique_ptr<CellFilling<dim>> filling;
    std::vector<bool> void_after;
    std::vector<bool> is_at_end; ///< cells that are full at the start, at the end of mesh or part
    std::vector<unsigned int> end_of_void; ///< cells void at the start that cannot be filled
  };
} // namespace tombolo
