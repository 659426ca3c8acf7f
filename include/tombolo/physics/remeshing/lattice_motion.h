// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/expression.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/state/nodal_vector.h>

#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * The motion of the mesh to whose places refills take nodes (`Refill motion`): a displacement as
   * a function of initial place and time, such as that of a tool, which fades out towards nodes
   * that stay. Material flows through a mesh that moves. Without it the mesh stays where it was at
   * the start.
   */
  template <int dim>
  class LatticeMotion
  {
  public:
    /** Throws InputError. Collective. */
    explicit LatticeMotion(const RefillSettings &settings);

    /** Whether the mesh moves. */
    bool is_on() const
    {
      return displacement.has_value();
    }

    /** The places of nodes of the mesh [L] that are at @p initial at the start, with ghosts.
     * Collective. */
    NodalVector places(const NodalVector &initial, double time) const;

    /** The same for the corners of @p cells. Throws InputError on all ranks if one is turned over.
     * Collective. */
    std::vector<typename SubCells<dim>::Corners>
    corners(const std::vector<SmoothedCell<dim>> &cells, double time, MPI_Comm communicator) const;

    /** How far a corner of @p cells has moved since the last refill, at most [L]. Collective. */
    double largest_way(const std::vector<SmoothedCell<dim>> &cells, double time,
                       MPI_Comm communicator) const;

    /** Adds the cells that the mesh has moved since the last refill to @p distorted, if there are
     * any of these, or if one has moved a tenth of its size. Collective. */
    void add_moved_cells(const std::vector<SmoothedCell<dim>> &cells, double time,
                         MPI_Comm communicator, std::vector<unsigned int> &distorted) const;

    /** @p position [L], moved by what the mesh has moved since the last refill, with ghosts.
     * Collective. */
    NodalVector follow(const NodalVector &initial, const NodalVector &position, double time) const;

    double time_of_last = 0; ///< refill [T]

  private:
    dealii::Tensor<1, dim> at(const dealii::Point<dim> &place, double time) const;
    /** What a place of the initial mesh has moved since the last refill. */
    dealii::Tensor<1, dim> way(const dealii::Point<dim> &place, double time) const;
    /** The longest way of a corner. */
    double largest_way(const SmoothedCell<dim> &cell, double time) const;
    /** @p from, moved by a function of the place of each node at the start, with ghosts. */
    template <typename Way>
    NodalVector move(const NodalVector &initial, const NodalVector &from, const Way &way) const;

    const RefillSettings &settings;
    std::optional<Expression<dim>> displacement;
  };
} // namespace tombolo
