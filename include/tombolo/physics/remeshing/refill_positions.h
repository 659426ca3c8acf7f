// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/formulations/smoothed/refill_settings.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/filled_positions.h>
#include <tombolo/physics/remeshing/lattice_motion.h>
#include <tombolo/physics/remeshing/surface_slide.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/inner_positions.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * The positions of the nodes of a part after a refill: inner nodes of distorted cells and of
   * layers around them are placed as in the initial lattice. Nodes of the boundary of the part
   * slide on it (SurfaceSlide) or stay, and those with prescribed components stay, as do those of
   * cells beside cells of another size. Where cells would turn over, nodes move a part of their
   * way. With void cells FilledPositions finds the positions.
   */
  template <int dim>
  class RefillPositions
  {
  public:
    using Corners = typename SubCells<dim>::Corners;
    using CellNodes = std::vector<std::array<unsigned int, SubCells<dim>::n_corners>>;

    /** Of the part with this number. Throws InputError if the motion of the mesh turns a cell over
     * at the end of the run, @p end_time. Collective. */
    RefillPositions(const Model<dim> &model, const unsigned int number,
                    const SmoothedCells<dim> &smoothed_cells, const double end_time)
        : motion(smoothed_cells.refill()), part(smoothed_cells), settings(smoothed_cells.refill()),
          cells(smoothed_cells_of(mesh_of_part(model, number)))
    {
      motion.corners(cells, end_time, model.communicator);
      if (settings.fills_cells)
      {
        set_partition(*model.state.partition());
        with_void =
            std::make_unique<FilledPositions<dim>>(model, number, smoothed_cells, local_nodes);
      }
      else if (settings.surface_slides)
        surface = std::make_unique<SurfaceSlide<dim>>(model, cells, local_nodes);
    }

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
    void set_partition(const NodePartition &partition)
    {
      local_nodes.resize(cells.size());
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
          local_nodes[c][k] = partition.local_index(cells[c].nodes[k]);
    }

    /** Null where no cells are filled and emptied. */
    FilledPositions<dim> *filled() const
    {
      return with_void.get();
    }

    /** The positions of all nodes after a refill of these cells. @p volumes: see FilledPositions.
     * Collective. */
    NodalVector find(const Model<dim> &model, const Clock &clock,
                     const std::vector<unsigned int> &distorted, const std::vector<double> &volumes)
    {
      std::vector<unsigned int> to_refill = distorted;
      if (with_void)
        with_void->add_displaced_cells(model, clock, motion, to_refill);
      find_free_nodes(model, to_refill);
      if (with_void)
        return with_void->find(model, clock, motion, in_patch, volumes);
      return surface ? find_below_sliding_surface(model, clock) : find_below_held_surface(model);
    }

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
    void find_free_nodes(const Model<dim> &model, const std::vector<unsigned int> &distorted)
    {
      const auto &partition = model.state.partition();
      std::vector<bool> is_in_patch(cells.size(), false);
      for (const unsigned int cell : distorted)
        is_in_patch[cell] = true;
      in_patch = CellMarks::nodes_of(partition, local_nodes, is_in_patch);
      for (unsigned int layer = 0; layer < settings.layers; ++layer)
      {
        is_in_patch = CellMarks::cells_marked(local_nodes, in_patch);
        in_patch = CellMarks::nodes_of(partition, local_nodes, is_in_patch);
      }
      // Nodes of cells that have become particles stay.
      for (unsigned int c = 0; c < cells.size() && !with_void; ++c)
        if (part.is_removed(c))
          is_in_patch[c] = false;
      const NodalVector between_sizes = CellMarks::nodes_between_sizes<dim>(cells, partition);
      const NodalVector is_held = CellMarks::nodes_of(partition, local_nodes, is_in_patch, false);
      const NodalVector boundary_nodes = marked_nodes(
          partition,
          [&](const auto &mark)
          {
            for (std::size_t c = 0; c < cells.size(); ++c)
              for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell; ++face)
                for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
                  if (cells[c].is_on_boundary[face] && SubCells<dim>::is_on_face(k, face))
                    mark(local_nodes[c][k]);
          });
      const dealii::IndexSet prescribed = model.conditions->prescribed_nodes();
      inside.reinit(partition, Quantity::scalar);
      on_surface = scalar_field(
          partition,
          [&](const unsigned int i)
          {
            if (!(*in_patch.node(i) > 0. && *is_held.node(i) == 0.) ||
                *between_sizes.node(i) > 0. || prescribed.is_element(partition->global_index(i)))
              return 0.;
            if (*boundary_nodes.node(i) == 0.)
              *inside.node(i) = 1.;
            return *boundary_nodes.node(i) > 0. && surface && surface->is_smooth(i) ? 1. : 0.;
          });
    }

    NodalVector find_below_held_surface(const Model<dim> &model) const
    {
      constexpr double smallest_share = 0.1;
      const NodalVector &position = model.state.position;
      std::vector<Corners> initial;
      for (const SmoothedCell<dim> &cell : cells)
        initial.push_back(cell.corners);
      NodalVector target = position.copy(), result = position.copy();
      place_inner_nodes<dim>(local_nodes, initial, inside, model.state.initial_position, target);
      for (double share = 1.; share > smallest_share; share *= 0.5)
      {
        result.fill(
            [&](const unsigned int i, double *const coordinates)
            {
              for (unsigned int d = 0; d<dim && * inside.node(i)> 0.; ++d)
                coordinates[d] = share * target.node(i)[d] + (1. - share) * position.node(i)[d];
            });
        if (!nodes_of_unusable_cells(position, result))
          return result;
      }
      return position.copy();
    }

    NodalVector find_below_sliding_surface(const Model<dim> &model, const Clock &clock)
    {
      constexpr unsigned int n_steps = 8, most_attempts = 10;
      constexpr double negligible = 1e-9; // of the first step: the next one is far below
      const NodalVector &position = model.state.position;
      const NodalVector mesh_positions = motion.positions(model.state.initial_position, clock.time);
      const std::vector<Corners> lattice_corners =
          motion.corners(cells, clock.time, model.communicator);
      const NodalVector all_inside = inside.copy();
      NodalVector result = slide_surface(model, clock, mesh_positions), trial = position.copy();
      double first_way = 0;
      for (unsigned int step = 0; step < n_steps; ++step)
      {
        NodalVector way =
            winslow_step<dim>(local_nodes, lattice_corners, all_inside, mesh_positions, result);
        bool is_possible = false;
        for (unsigned int attempt = 0; attempt < most_attempts && !is_possible; ++attempt)
        {
          trial.fill(
              [&](const unsigned int i, double *const coordinates)
              {
                for (unsigned int d = 0; d < node_stride; ++d)
                  coordinates[d] = result.node(i)[d] + way.node(i)[d];
              });
          const auto unusable = nodes_of_unusable_cells(result, trial);
          is_possible = !unusable;
          for (unsigned int i = 0; unusable && i < position.partition()->n_owned(); ++i)
            if (*unusable->node(i) > 0.)
              for (unsigned int d = 0; d < dim; ++d)
                way.node(i)[d] *= 0.25;
        }
        if (!is_possible)
          break;
        result.copy_from(trial);
        double largest = 0;
        for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
          largest = std::max(largest, vector_of<dim>(way.node(i)).norm_square());
        largest = dealii::Utilities::MPI::max(std::sqrt(largest), model.communicator);
        first_way = step == 0 ? largest : first_way;
        if (largest <= negligible * first_way)
          break;
      }
      return result;
    }

    /** Positions at which the surface has slid towards @p mesh_positions, and nodes below it have
     * followed. Nodes that cannot may not move any more. Collective. */
    NodalVector slide_surface(const Model<dim> &model, const Clock &clock,
                              const NodalVector &mesh_positions)
    {
      constexpr unsigned int most_attempts = 20;
      constexpr double reduction = 1e-3; // of the residual: the following steps correct it
      const NodalVector &position = model.state.position;
      const std::vector<Corners> present = corners_at<dim>(local_nodes, position);
      const NodalVector moved = motion.follow(model.state.initial_position, position, clock.time);
      const double way = motion.largest_way(cells, clock.time, model.communicator);
      const auto contacts = shown_by_processes<SurfaceContact<dim>>(model);
      NodalVector result = position.copy();
      NodalVector stays =
          scalar_field(position.partition(), [&](const unsigned int i)
                       { return *on_surface.node(i) == 0. && *inside.node(i) == 0. ? 1. : 0.; });
      for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
      {
        result.fill(
            [&](const unsigned int i, double *const coordinates) {
              std::copy_n((*stays.node(i) > 0. ? position : moved).node(i), node_stride,
                          coordinates);
            });
        surface->slide(
            on_surface, mesh_positions, position,
            [&](const NodalVector &from, NodalVector &positions, NodalVector &is_bound)
            { model.signals.nodes_move(clock, on_surface, from, positions, is_bound); },
            result);
        std::optional<NodalVector> wrong;
        if (!contacts.empty())
          wrong = surface->nodes_of_cut_faces(
              on_surface, position, result, way,
              [&](const NodalVector &positions, const std::vector<unsigned int> &numbers,
                  std::vector<double> &depths)
              {
                depths.assign(numbers.size(), std::numeric_limits<double>::lowest());
                std::vector<double> gaps;
                for (const auto *const contact : contacts)
                {
                  contact->find_gaps(positions, numbers, clock.time, gaps);
                  for (std::size_t k = 0; k < numbers.size(); ++k)
                    depths[k] = std::max(depths[k], -gaps[k]);
                }
              });
        const bool is_cut = wrong.has_value();
        if (!is_cut)
        {
          place_inner_nodes<dim>(local_nodes, present, inside, moved, result, reduction);
          wrong = nodes_of_unusable_cells(position, result);
        }
        if (!wrong)
          return result;
        hold_nodes(*wrong, is_cut, stays);
      }
      on_surface.set_zero();
      return position.copy();
    }

    /** Holds the marked nodes: where the mesh moves, those that were free move with it; others are
     * added to those that stay. Collective. */
    void hold_nodes(const NodalVector &marks, const bool only_on_surface, NodalVector &stays)
    {
      on_surface.fill(
          [&](const unsigned int i, double *const slides)
          {
            if (!(*marks.node(i) > 0.) || *stays.node(i) > 0. || (only_on_surface && *slides == 0.))
              return;
            const bool was_free = *slides == SurfaceSlide<dim>::relaxes || *inside.node(i) > 0.;
            *inside.node(i) = 0.;
            const bool keeps_moving = motion.is_on() && was_free;
            *slides = keeps_moving && *slides > 0. ? SurfaceSlide<dim>::moves_with_mesh : 0.;
            *stays.node(i) = keeps_moving ? 0. : 1.;
          });
    }

    /** Scalar, with ghosts: positive at the nodes of cells that would be turned over. Nothing if
     * there is none. Collective. */
    std::optional<NodalVector> nodes_of_unusable_cells(const NodalVector &before,
                                                       const NodalVector &after) const
    {
      std::vector<bool> is_unusable;
      for (const auto &nodes : local_nodes)
      {
        const Corners corners = corners_at<dim>(nodes, after);
        is_unusable.push_back(corners != corners_at<dim>(nodes, before) &&
                              !CellSimplices<dim>::are_positive(corners));
      }
      if (!any_of_all_ranks(
              is_unusable, [](const bool is_one) { return is_one; },
              before.partition()->communicator()))
        return {};
      return CellMarks::nodes_of(before.partition(), local_nodes, is_unusable);
    }

    const SmoothedCells<dim> &part;
    const RefillSettings<dim> &settings;
    std::vector<SmoothedCell<dim>> cells;
    CellNodes local_nodes;
    std::unique_ptr<SurfaceSlide<dim>> surface; // null: nodes of the boundary do not slide by it
    std::unique_ptr<FilledPositions<dim>> with_void; // null: no void cells
    NodalVector in_patch, inside, on_surface;        // scalar
  };
} // namespace tombolo
