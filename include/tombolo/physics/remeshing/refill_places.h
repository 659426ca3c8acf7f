// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
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
   * Where a refill places the nodes of a part: inner nodes of distorted cells and of layers around
   * them as in the lattice of the start. Nodes of the boundary of the part slide on it
   * (SurfaceSlide) or stay, and those with prescribed components stay. Where cells would turn over,
   * nodes go a part of their way.
   *
   * With void cells it says as well which cells are full then (CellFilling): nodes of the surface
   * of these go to the surface of before, and nodes of void cells alone to their places in the
   * mesh.
   */
  template <int dim>
  class RefillPlaces
  {
  public:
    using Corners = typename SubCells<dim>::Corners;
    using CellNodes = std::vector<std::array<unsigned int, SubCells<dim>::n_corners>>;

    /** Throws InputError if the motion of the mesh turns a cell over at the end of the run, @p
     * end_time. Collective. */
    RefillPlaces(const Model<dim> &model, unsigned int part, const SmoothedCells<dim> &of_part,
                 double end_time);

    /** The cells of the part on this rank, with their initial corners. */
    const std::vector<SmoothedCell<dim>> &lattice() const
    {
      return cells;
    }

    /** Their corners as local numbers of the partition that was set. */
    const CellNodes &nodes() const
    {
      return local_nodes;
    }
    void set_partition(const NodePartition &partition);

    /** Whether nodes of the surface slide. */
    bool slides() const
    {
      return surface != nullptr;
    }

    /** Adds the cells that are to be refilled because the mesh moves. Collective. */
    void add_moved_cells(const Model<dim> &model, const Clock &clock,
                         std::vector<unsigned int> &distorted) const
    {
      motion.add_moved_cells(cells, clock.time, model.communicator, distorted);
    }

    /** The time of the last refill, for a checkpoint [T]. */
    double &time_of_last()
    {
      return motion.time_of_last;
    }

    /** The places of all nodes after a refill of these cells. Collective. */
    NodalVector find(const Model<dim> &model, const Clock &clock,
                     const std::vector<unsigned int> &distorted);

    /** Which cells of this rank are void after the last find(). Only with void cells. */
    const std::vector<bool> &next_void() const
    {
      return void_after;
    }

    /** Adds the full cells next to void ones whose surface has moved by three tenths of their size
     * from @p reference, the owned positions of the last refill. Collective. */
    void add_cells_at_void(const Model<dim> &model, const NodalVector &reference,
                           std::vector<unsigned int> &distorted) const;

    /** Takes the void cells of the part as they are now. Collective. */
    void take_void_cells(const Model<dim> &model);

    /** Scalar, with ghosts: positive at the nodes of cells at the surface, and of those next to
     * them. Only with void cells. Collective. */
    NodalVector nodes_near_surface(const Model<dim> &model) const;

    /** Scalar, positive at the nodes of the cells of the last refill. */
    const NodalVector &nodes_of_patch() const
    {
      return in_patch;
    }

    /** Scalar, with ghosts, positive at the nodes that slid in it. */
    const NodalVector &sliding_nodes() const
    {
      return on_surface;
    }

  private:
    /** Finds the nodes that may move. Collective. */
    void find_free_nodes(const Model<dim> &model, const std::vector<unsigned int> &distorted);
    /** Marks the nodes of the cells that are chosen, or of those that are not. Collective. */
    void mark_nodes(const std::vector<bool> &is_chosen, bool of_chosen, NodalVector &marks) const;
    NodalVector find_below_held_surface(const Model<dim> &model) const;
    NodalVector find_below_sliding_surface(const Model<dim> &model, const Clock &clock);
    /** Positions at which the surface has slid towards @p mesh_places, and nodes below it have
     * followed. Nodes that cannot are taken out of those that may move. Collective. */
    NodalVector slide_surface(const Model<dim> &model, const Clock &clock,
                              const NodalVector &mesh_places);
    /** Holds the marked nodes: where the mesh moves, those that were free go with it; others are
     * added to those that stay. Collective. */
    void hold_nodes(const NodalVector &marks, bool only_on_surface, NodalVector &stays);
    /** Scalar, with ghosts: positive at the nodes of cells that would be turned over. Nothing if
     * there is none. Collective. */
    std::optional<NodalVector> nodes_of_unusable_cells(const NodalVector &before,
                                                       const NodalVector &after) const;
    bool is_usable(unsigned int cell, const NodalVector &before, const NodalVector &after) const;
    /** find() with void cells. Collective. */
    NodalVector find_with_void_cells(const Model<dim> &model, const Clock &clock);
    /** The cells of the part with these void ones, and what can slide on their surface. Collective.
     */
    std::vector<SmoothedCell<dim>> cells_with(const Model<dim> &model,
                                              const std::vector<bool> &is_void) const;
    /** Marks what nodes do that are not @p held. Collective. */
    void classify_nodes(const Model<dim> &model, const SurfaceSlide<dim> &next,
                        const NodalVector &held);
    /** Corners of the cells at @p position. */
    std::vector<Corners> corners_of_cells(const NodalVector &position) const;

    const RefillSettings &settings;
    const VoidCells<dim> &voids;
    unsigned int part;
    std::vector<SmoothedCell<dim>> cells;
    LatticeMotion<dim> motion;
    CellNodes local_nodes;
    std::unique_ptr<SurfaceSlide<dim>> surface; // null: nodes of the boundary stay
    NodalVector in_patch, inside, on_surface;   // scalar
    std::unique_ptr<CellFilling<dim>> filling;  // null: no void cells
    std::vector<bool> void_after;
  };
} // namespace tombolo
