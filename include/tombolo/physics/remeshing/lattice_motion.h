// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The motion of the mesh to whose nodes refills move those of the part (`Refill motion`): a
   * displacement as a function of initial position and time, such as that of a tool, which fades
   * out towards nodes that stay. Material flows through a mesh that moves. Without it the mesh
   * stays where it was at the start. Where it has no value on one rank all throw a RunError.
   */
  template <int dim>
  class LatticeMotion
  {
  public:
    /** Throws InputError. Collective. */
    explicit LatticeMotion(const RefillSettings<dim> &settings)
        : settings(settings), displacement(settings.motion())
    {}

    /** Whether the mesh moves. */
    bool is_on() const
    {
      return displacement.has_value();
    }

    /** The positions of nodes of the mesh [L] that are at @p initial at the start, with ghosts.
     * Collective. */
    NodalVector positions(const NodalVector &initial, const double time) const
    {
      return move(initial, initial,
                  [&](const dealii::Point<dim> &point) { return at(point, time); });
    }

    /** The same for the corners of @p cells. Throws InputError on all ranks if one is turned over.
     * Collective. */
    std::vector<typename SubCells<dim>::Corners>
    corners(const std::vector<SmoothedCell<dim>> &cells, const double time,
            const MPI_Comm communicator) const
    {
      std::vector<typename SubCells<dim>::Corners> result;
      std::string problem;
      const auto add = [&](const SmoothedCell<dim> &cell)
      {
        result.push_back(cell.corners);
        if (!is_on())
          return;
        for (dealii::Point<dim> &corner : result.back())
          corner += at(corner, time);
        const auto volumes = CellSimplices<dim>::volumes(result.back());
        if (problem.empty() && !(*std::min_element(volumes.begin(), volumes.end()) > 0.))
        {
          problem = as_text("at t = ", time, " it turns a cell of the mesh over, which is around (",
                            cell.centre(), ") at the start.");
        }
      };
      attempt_on_all_ranks<RunError>(communicator,
                                     [&] { std::for_each(cells.begin(), cells.end(), add); });
      if (const std::string first = first_text(communicator, problem); !first.empty())
        settings.refuse(first, "Refill motion");
      return result;
    }

    /** How far a corner of @p cells has moved since the last refill, at most [L]. Collective. */
    double largest_way(const std::vector<SmoothedCell<dim>> &cells, const double time,
                       const MPI_Comm communicator) const
    {
      double result = 0;
      if (!is_on())
        return result;
      attempt_on_all_ranks<RunError>(communicator,
                                     [&]
                                     {
                                       for (const SmoothedCell<dim> &cell : cells)
                                         result = std::max(result, largest_way(cell, time));
                                     });
      return dealii::Utilities::MPI::max(result, communicator);
    }

    /** Adds the cells that the mesh has moved since the last refill to @p distorted, if there are
     * any of these, or if one has moved a tenth of its size. Collective. */
    void add_moved_cells(const std::vector<SmoothedCell<dim>> &cells, const double time,
                         const MPI_Comm communicator, std::vector<unsigned int> &distorted) const
    {
      constexpr double far = 0.1; // of the size of a cell
      if (!is_on())
        return;
      bool is_far = !distorted.empty();
      std::vector<unsigned int> moved, all;
      const auto examine = [&](const unsigned int c)
      {
        const auto &corners = cells[c].corners;
        const double cell_way = largest_way(cells[c], time);
        is_far = is_far || cell_way > far * corners[0].distance(corners[1]);
        if (cell_way > 0.)
          moved.push_back(c);
      };
      attempt_on_all_ranks<RunError>(communicator,
                                     [&]
                                     {
                                       for (unsigned int c = 0; c < cells.size(); ++c)
                                         examine(c);
                                     });
      if (dealii::Utilities::MPI::max(is_far ? 1 : 0, communicator) == 0)
        return;
      std::set_union(distorted.begin(), distorted.end(), moved.begin(), moved.end(),
                     std::back_inserter(all));
      distorted = std::move(all);
    }

    /** @p position [L] plus the displacement of the mesh since the last refill, with ghosts.
     * Collective. */
    NodalVector follow(const NodalVector &initial, const NodalVector &position,
                       const double time) const
    {
      return move(initial, position,
                  [&](const dealii::Point<dim> &point) { return way(point, time); });
    }

    double time_of_last = 0; ///< refill [T]

  private:
    dealii::Tensor<1, dim> at(const dealii::Point<dim> &point, const double time) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; displacement && d < dim; ++d)
        result[d] = displacement->value(point, time, d);
      return result;
    }

    /** The way of a point of the initial mesh since the last refill [L]. */
    dealii::Tensor<1, dim> way(const dealii::Point<dim> &point, const double time) const
    {
      return at(point, time) - at(point, time_of_last);
    }

    /** The longest way of a corner. */
    double largest_way(const SmoothedCell<dim> &cell, const double time) const
    {
      double result = 0;
      for (const dealii::Point<dim> &corner : cell.corners)
        result = std::max(result, way(corner, time).norm());
      return result;
    }

    /** @p from, moved by a function of the initial position of each node, with ghosts. */
    template <typename Way>
    NodalVector move(const NodalVector &initial, const NodalVector &from, const Way &way) const
    {
      NodalVector result = from.copy();
      const auto move_node = [&](const unsigned int i)
      {
        const dealii::Tensor<1, dim> node_way = way(point_of<dim>(initial.node(i)));
        for (unsigned int d = 0; d < dim && is_on(); ++d)
          result.node(i)[d] += node_way[d];
      };
      change_owned({&result},
                   [&]
                   {
                     attempt_on_all_ranks<RunError>(from.partition()->communicator(),
                                                    [&]
                                                    {
                                                      for (unsigned int i = 0;
                                                           i < from.partition()->n_owned(); ++i)
                                                        move_node(i);
                                                    });
                   });
      return result;
    }

    const RefillSettings<dim> &settings;
    std::optional<Expression<dim>> displacement;
  };
} // namespace tombolo
