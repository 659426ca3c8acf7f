// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/filled_places.h>
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
   * (SurfaceSlide) or stay, and those with prescribed components stay, as do those of cells beside
   * cells of another size. Where cells would turn over, nodes go a part of their way. With void
   * cells FilledPlaces says where nodes go.
   */
  template <int dim>
  class RefillPlaces
  {
  public:
    using Corners = typename SubCells<dim>::Corners;
    using CellNodes = std::vector<std::array<unsigned int, SubCells<dim>::n_corners>>;

    /** Of the part with this number. Throws InputError if the motion of the mesh turns a cell over
     * at the end of the run, @p end_time. Collective. */
    RefillPlaces(const Model<dim> &model, unsigned int number, const SmoothedCells<dim> &of_part,
                 double end_time);

    /** The cells of the part on this rank, initially. */
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

    /** What fills and empties cells; null where they stay full. */
    FilledPlaces<dim> *filled() const
    {
      return with_void.get();
    }

    /** The places of all nodes after a refill of these cells. @p volumes: see FilledPlaces.
     * Collective. */
    NodalVector find(const Model<dim> &model, const Clock &clock,
                     const std::vector<unsigned int> &distorted,
                     const std::vector<double> &volumes);

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

    LatticeMotion<dim> motion;

  private:
    /** Finds the nodes that may move. Collective. */
    void find_free_nodes(const Model<dim> &model, const std::vector<unsigned int> &distorted);
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

    const SmoothedCells<dim> &part;
    const RefillSettings &settings;
    std::vector<SmoothedCell<dim>> cells;
    CellNodes local_nodes;
    std::unique_ptr<SurfaceSlide<dim>> surface;   // null: nodes of the boundary do not slide by it
    std::unique_ptr<FilledPlaces<dim>> with_void; // null: no void cells
    NodalVector in_patch, inside, on_surface;     // scalar
  };
} // namespace tombolo
