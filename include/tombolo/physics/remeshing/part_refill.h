// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/refill_places.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/point_remap.h>

#include <memory>
#include <vector>

namespace tombolo
{
  template <int dim>
  class NodalContent;

  /** The refills of one part of smoothed cells. */
  template <int dim>
  class PartRefill
  {
  public:
    PartRefill(const Model<dim> &model, unsigned int part, SmoothedCells<dim> &cells,
               double end_time);

    /**
     * Where cells have reached a limit: places inner nodes of these cells and of layers around them
     * as in the lattice of the start, makes the present configuration the reference, and remaps
     * velocities, heat and points conservatively or by a ValueRemap. Nodes of the boundary of the
     * part slide on it (SurfaceSlide) or stay, and those with prescribed components stay. Where
     * cells would turn over, the nodes go a part of their way. With void cells, cells are filled
     * and emptied as well. Returns whether there was a refill; masses of nodes and the partition
     * are renewed then. Collective.
     */
    bool refill(Model<dim> &model, const Clock &clock);

    /** Scalar, positive at the owned nodes of cells that the last refill was made for: where lost
     * energy goes. */
    const NodalVector &touched_nodes() const
    {
      return places.nodes_of_patch();
    }

    /** Owned nodes that the last refill moved, local numbers. */
    const std::vector<unsigned int> &moved_nodes() const
    {
      return moved;
    }

    /** See FilledPlaces; only where cells are filled. Collective. */
    std::optional<dealii::Point<dim>> reached_end(const MPI_Comm communicator) const
    {
      return places.filled()->reached_end(communicator);
    }

    unsigned long n_refills() const
    {
      return count;
    }

    /** Writes or reads how the part is referred to, before its points are read. Returns whether it
     * has another reference than the initial one. Collective. */
    bool serialize(const Model<dim> &model, StateArchive &archive);

    const unsigned int part;
    const RefillSettings &settings;

  private:
    using Corners = typename SubCells<dim>::Corners;

    using Cells = std::vector<RemapCell<dim>>;

    Cells remap_cells(const Model<dim> &model, const NodalVector &after) const;
    /** Notes the places of the nodes that a refill has taken. */
    void settle(const Model<dim> &model, const NodalVector &after);
    /** What the material of each cell takes, m J/ρ₀ [L^dim]; only where cells are filled. */
    std::vector<double> material_volumes();
    /** Takes these positions as the reference, with the void cells of these places. Returns whether
     * that is possible; nothing has changed otherwise. Collective. */
    bool renew_reference(const NodalVector &after);
    PointValues get_points(Cells &remapped);
    void set_points(const Cells &remapped, const PointValues &values,
                    const std::vector<double> &volumes);
    /** The lumped masses of the cells of after. */
    void set_masses(const CellOverlap<dim> &overlap);
    /** The masses of the part at nodes, scalar, owned. Collective. */
    NodalVector own_mass(const std::shared_ptr<const NodePartition> &partition) const;
    void remap(Model<dim> &model, const NodalVector &after, const Clock &clock, Cells &remapped,
               PointValues &points);
    /** Integrals over the overlap of cells. Collective. */
    void remap_conservatively(Model<dim> &model, Cells &remapped, NodalContent<dim> &nodal,
                              PointValues &points);
    /** Values at new places. Collective. */
    void remap_by_values(Model<dim> &model, const NodalVector &after, const Cells &remapped,
                         NodalContent<dim> &nodal, PointValues &points);
    /** Gives points and nodes of cells that have moved the masses of ρ₀/J and these volumes of
     * points, times one number that keeps the sum of each. Collective. */
    void take_masses(const Cells &remapped, const std::vector<double> &volumes, PointValues &points,
                     MPI_Comm communicator);

    SmoothedCells<dim> &cells;
    RefillPlaces<dim> places;
    SmoothedIntegrationRule rule;
    std::unique_ptr<ValueRemap<dim>> by_values; ///< null: the remap is conservative
    NodalVector reference;
    NodalVector settled; ///< where the last refill of each node has put it; where cells are filled
    /** Of the points, by cell; empty before the first refill. Beside J, since the volume of a
     * cell and the determinants of its points follow different means of the motion [M]. */
    std::vector<double> point_mass;
    std::vector<unsigned int> moved;
    std::vector<double> bodies; ///< of cells; for a ValueRemap
    unsigned long count = 0;
  };
} // namespace tombolo
