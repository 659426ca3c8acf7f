// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/cell_filling.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/lattice_motion.h>
#include <tombolo/physics/remeshing/surface_slide.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/inner_positions.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

namespace tombolo
{
  /**
   * The positions of the nodes of a part with void cells after a refill that fills and empties
   * cells: cells of the mesh are full where the body has at least half of them (CellFilling). Nodes
   * on their surface move from their positions in the mesh to the former surface (SurfaceSlide),
   * inner nodes follow, and nodes of void cells alone have their positions in the mesh. Where a
   * cell would become too thin, nodes of the surface move a part of this way only, and in the end
   * stay, as cells around them stay full or void.
   */
  template <int dim>
  class FilledPositions
  {
  public:
    using Corners = typename SubCells<dim>::Corners;
    using CellNodes = std::vector<std::array<unsigned int, SubCells<dim>::n_corners>>;

    /** @p nodes: local numbers of the corners of the cells, which must be current in all calls.
     * Collective. */
    FilledPositions(const Model<dim> &model, const unsigned int part,
                    const SmoothedCells<dim> &smoothed_cells, const CellNodes &nodes)
        : voids(smoothed_cells.void_cells()), local_nodes(nodes), part(part)
    {
      update_void_cells(model);
      for (const SmoothedCell<dim> &cell : cells)
      {
        bool has_end = false;
        for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell; ++face)
          has_end = has_end || (cell.is_on_boundary[face] && !cell.is_towards_void[face]);
        is_at_end.push_back(has_end);
      }
      find_end_of_void(model);
      filling =
          std::make_unique<CellFilling<dim>>(ids_of_corners(model, cells), model.communicator);
    }

    /** Adds the full cells next to void ones whose surface has moved by three tenths of their size
     * since its last refill, @p refilled_position (owned). Collective. */
    void add_cells_at_void(const Model<dim> &model, const NodalVector &refilled_position,
                           std::vector<unsigned int> &distorted) const
    {
      constexpr double share_of_size = 0.3;
      const NodalVector ways = difference(model.state.position, refilled_position);
      for (unsigned int c = 0; c < cells.size(); ++c)
      {
        bool has_moved = false;
        for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell; ++face)
        {
          if (!cells[c].is_towards_void[face])
            continue;
          const double way = share_of_size * sizes_of(cells[c])[face / 2];
          for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
            has_moved = has_moved ||
                        (SubCells<dim>::is_on_face(k, face) &&
                         vector_of<dim>(ways.node(local_nodes[c][k])).norm_square() > way * way);
        }
        if (has_moved)
          distorted.push_back(c);
      }
    }

    /** Adds the full cells with a node farther than half of their size from its position in the
     * mesh, so that nodes that stay are near to it; not those whose nodes always stay.
     * Collective. */
    void add_displaced_cells(const Model<dim> &model, const Clock &clock,
                             const LatticeMotion<dim> &motion,
                             std::vector<unsigned int> &distorted) const
    {
      constexpr double share_of_size = 0.5;
      const NodalVector ways = difference(
          model.state.position, motion.positions(model.state.initial_position, clock.time));
      for (unsigned int c = 0; c < cells.size(); ++c)
      {
        const dealii::Tensor<1, dim> sizes = sizes_of(cells[c]);
        bool is_displaced = false;
        const bool counts = !voids.is_void_by_cell()[c] && !cells[c].has_further_nodes();
        for (unsigned int k = 0; k < local_nodes[c].size() && counts; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            is_displaced = is_displaced ||
                           std::abs(ways.node(local_nodes[c][k])[d]) > share_of_size * sizes[d];
        if (is_displaced)
          distorted.push_back(c);
      }
    }

    /** The positions of all nodes; only those that @p in_patch marks (scalar, with ghosts) move,
     * and not those of cells beside cells of another size. @p volumes: of the material of each cell
     * [L^dim]; cells that move keep the sum. Collective. */
    NodalVector find(const Model<dim> &model, const Clock &clock, const LatticeMotion<dim> &motion,
                     const NodalVector &in_patch, const std::vector<double> &volumes)
    {
      constexpr unsigned int most_attempts = 20;
      const NodalVector &position = model.state.position;
      Search search = begin_search(model, clock, motion, in_patch, volumes);
      for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
      {
        NodalVector result = try_positions(model, clock, search);
        const auto is_thin = thin_cells(position, result, search);
        if (!is_thin)
          return result;
        relax_thin_cells(*is_thin, search);
      }
      void_after = voids.is_void_by_cell();
      return position.copy();
    }

    /** Which cells of this rank are void then. */
    const std::vector<bool> &next_void() const
    {
      return void_after;
    }

    /** The centre of a cell that was void at the start and cannot be filled, at the end of the mesh
     * or beside cells of another size, and of which the body had half at the last search, the same
     * on all ranks; nothing where there is none. Collective.
     */
    std::optional<dealii::Point<dim>> reached_end(const MPI_Comm communicator) const
    {
      constexpr double from_share = 0.5;
      std::vector<dealii::Point<dim>> reached;
      for (const unsigned int c : end_of_void)
        if (reached.empty() && filling->is_measured() && filling->share(c) >= from_share)
          reached.push_back(cells[c].centre());
      reached = from_all_ranks(reached, communicator);
      return reached.empty() ? std::nullopt : std::make_optional(reached.front());
    }

    /** Updates the void cells of the part. Collective. */
    void update_void_cells(const Model<dim> &model)
    {
      cells = smoothed_cells_of(mesh_of_part(model, part, &voids));
      surface = std::make_unique<SurfaceSlide<dim>>(model, cells, local_nodes);
    }

    /** Scalar, with ghosts: positive at the nodes of cells at the surface, and of those next to
     * them. Collective. */
    NodalVector nodes_near_surface(const Model<dim> &model) const
    {
      const auto &partition = model.state.partition();
      const NodalVector on_boundary = scalar_field(
          partition, [&](const unsigned int i) { return surface->is_on_boundary(i) ? 1. : 0.; });
      return CellMarks::nodes_of(partition, local_nodes,
                                 CellMarks::cells_marked(local_nodes, on_boundary));
    }

  private:
    /** The data of a search for positions. */
    struct Search
    {
      NodalVector mesh_positions, in_patch, held; ///< nodes that stay (scalar, with ghosts)
      NodalVector way_shares;                     ///< scalar, owned
      NodalVector inside, on_surface;             ///< nodes that move (scalar)
      double volume = 0;                          ///< of cells with a node in the patch
      std::vector<Corners> mesh;                  ///< corners of the cells there
      std::vector<bool> near;                     ///< cells with a node in the patch
      std::vector<bool> at_surface;               ///< those of them that can be filled or emptied
    };
    Search begin_search(const Model<dim> &model, const Clock &clock,
                        const LatticeMotion<dim> &motion, const NodalVector &in_patch,
                        const std::vector<double> &volumes)
    {
      const NodalVector &position = model.state.position;
      const auto &partition = position.partition();
      const dealii::IndexSet prescribed = model.conditions->prescribed_nodes();
      const NodalVector between_sizes = CellMarks::nodes_between_sizes<dim>(cells, partition);
      Search search;
      search.mesh_positions = motion.positions(model.state.initial_position, clock.time);
      search.mesh = motion.corners(cells, clock.time, model.communicator);
      search.in_patch = in_patch.copy();
      search.near = CellMarks::cells_marked(local_nodes, search.in_patch);
      search.at_surface = CellMarks::cells_marked(local_nodes, nodes_near_surface(model));
      for (std::size_t c = 0; c < cells.size(); ++c)
        search.at_surface[c] = search.at_surface[c] && search.near[c];
      search.way_shares = scalar_field(partition, [](const unsigned int) { return 1.; });
      search.held = CellMarks::nodes_of(partition, local_nodes, search.near, false);
      search.held.fill(
          [&](const unsigned int i, double *const is_held)
          {
            if (prescribed.is_element(partition->global_index(i)) || *between_sizes.node(i) > 0. ||
                (surface->is_on_boundary(i) && !surface->is_smooth(i)))
              *is_held = 1.;
          });
      filling->measure(voids.is_void_by_cell(), corners_at<dim>(local_nodes, position), search.near,
                       search.mesh, search.at_surface);
      for (std::size_t c = 0; c < cells.size(); ++c)
        search.volume += search.near[c] ? volumes[c] : 0.;
      search.volume = ordered_sum(search.volume, model.communicator);
      return search;
    }

    /** The volume of void cells that the body had and has not at these positions, at those nodes of
     * the cell on the surface that are not bound, and near them. Collective. */
    NodalVector missing(const NodalVector &position, const NodalVector &is_bound,
                        const Search &search) const
    {
      const auto &partition = position.partition();
      const NodalVector moves = scalar_field(
          partition, [&](const unsigned int i)
          { return *search.on_surface.node(i) > 0. && *is_bound.node(i) == 0. ? 1. : 0.; });
      const std::vector<double> shares =
          filling->shares_in(void_after, corners_at<dim>(local_nodes, position), search.near,
                             search.mesh, search.at_surface);
      const auto add = [&](NodalVector &sums)
      {
        for (std::size_t c = 0; c < cells.size(); ++c)
        {
          if (!void_after[c] || !search.at_surface[c])
            continue;
          double n_moving = 0;
          for (const unsigned int node : local_nodes[c])
            n_moving += *moves.node(node);
          const auto volumes = CellSimplices<dim>::volumes(search.mesh[c]);
          const double missing_volume = std::max(0., filling->share(c) - shares[c]) *
                                        std::accumulate(volumes.begin(), volumes.end(), 0.);
          for (const unsigned int node : local_nodes[c])
            if (*moves.node(node) > 0.)
              *sums.node(node) += missing_volume / n_moving;
        }
      };
      return spread(moves, sums_at_owners(partition, Quantity::scalar, add));
    }

    /** Spreads values of nodes that move (one, zero for others; with ghosts) over those of the same
     * cells, some times: the sum stays, and the part that alternates between nodes vanishes.
     * Collective.
     */
    NodalVector spread(const NodalVector &moves, NodalVector values) const
    {
      constexpr unsigned int n_sweeps = 4;
      const auto &partition = moves.partition();
      std::vector<double> n_moving(cells.size(), 0.);
      const auto count = [&](NodalVector &sums)
      {
        for (std::size_t c = 0; c < cells.size(); ++c)
          for (const unsigned int node : local_nodes[c])
            if (!void_after[c] && *moves.node(node) > 0.)
            {
              n_moving[c] += 1.;
              *sums.node(node) += 1.;
            }
      };
      const NodalVector n_cells = sums_at_owners(partition, Quantity::scalar, count);
      const auto add_means = [&](NodalVector &sums)
      {
        for (std::size_t c = 0; c < cells.size(); ++c)
        {
          if (n_moving[c] == 0.)
            continue;
          double sum = 0;
          for (const unsigned int node : local_nodes[c])
            sum += *moves.node(node) * *values.node(node);
          for (const unsigned int node : local_nodes[c])
            *sums.node(node) += *moves.node(node) * sum / n_moving[c];
        }
      };
      for (unsigned int sweep = 0; sweep < n_sweeps; ++sweep)
      {
        values.fill([&](const unsigned int i, double *const value)
                    { *value /= std::max(1., *n_cells.node(i)); });
        values = sums_at_owners(partition, Quantity::scalar, add_means);
      }
      return values;
    }

    /** Chooses full cells, and moves the nodes. Collective. */
    NodalVector try_positions(const Model<dim> &model, const Clock &clock, Search &search)
    {
      const NodalVector &position = model.state.position;
      void_after = filling->choose(voids.is_void_by_cell(), search.near, changeable_cells(search));
      const SurfaceSlide<dim> next(model, cells_with(model, void_after), local_nodes);
      classify_nodes(next, search);
      NodalVector result = nodal_field(position.partition(), position.quantity(),
                                       [&](const unsigned int i, double *const coordinates)
                                       {
                                         const NodalVector &from = *search.held.node(i) > 0.
                                                                       ? position
                                                                       : search.mesh_positions;
                                         std::copy_n(from.node(i), node_stride, coordinates);
                                       });
      // A node that moves a part of its way only, because of its cells, may leave a tool.
      constexpr double whole_way = 1., part_of_way = 0.5;
      const NodalVector slides = scalar_field(
          position.partition(),
          [&](const unsigned int i)
          {
            const bool moves_all_way = *search.way_shares.node(i) == whole_way;
            return *search.on_surface.node(i) == 0. ? 0. : moves_all_way ? whole_way : part_of_way;
          });
      next.slide_onto(
          *surface, search.in_patch, search.volume, search.on_surface, search.way_shares,
          search.mesh_positions, position,
          [&](const NodalVector &from, NodalVector &positions, NodalVector &is_bound)
          { model.signals.nodes_move(clock, slides, from, positions, is_bound); },
          [&](const NodalVector &positions, const NodalVector &is_bound)
          { return missing(positions, is_bound, search); },
          result);
      place_inner_nodes<dim>(local_nodes, search.mesh, search.inside, search.mesh_positions,
                             result);
      return result;
    }

    /** Classifies the nodes that are not held. Collective. */
    void classify_nodes(const SurfaceSlide<dim> &next, Search &search) const
    {
      const auto &partition = search.held.partition();
      const NodalVector full_nodes = CellMarks::nodes_of(partition, local_nodes, void_after, false);
      for (NodalVector *const vector : {&search.inside, &search.on_surface})
        vector->reinit(partition, Quantity::scalar);
      change_owned({&search.held, &search.on_surface},
                   [&]
                   {
                     for (unsigned int i = 0; i < partition->n_owned(); ++i)
                       if (next.is_on_boundary(i) && !next.is_smooth(i))
                         *search.held.node(i) = 1.;
                       else if (*search.held.node(i) == 0. && *full_nodes.node(i) > 0.)
                         *(next.is_on_boundary(i) ? search.on_surface : search.inside).node(i) = 1.;
                   });
    }

    /** Which cells would be too thin; nothing if none would on any rank. Collective. */
    std::optional<std::vector<bool>> thin_cells(const NodalVector &before, const NodalVector &after,
                                                const Search &search) const
    {
      std::vector<bool> result(cells.size(), false);
      bool any = false;
      for (std::size_t c = 0; c < cells.size(); ++c)
      {
        const Corners corners = corners_at<dim>(local_nodes[c], after);
        const bool stays =
            !voids.is_void_by_cell()[c] && corners == corners_at<dim>(local_nodes[c], before);
        result[c] = !void_after[c] && !stays && is_thin(c, corners, search.at_surface[c]);
        any = any || result[c];
      }
      if (dealii::Utilities::MPI::max(any ? 1 : 0, before.partition()->communicator()) == 0)
        return {};
      return result;
    }

    bool is_thin(const std::size_t cell, const Corners &corners, const bool is_at_surface) const
    {
      constexpr double smallest_share = 0.2; // of the volume of a sub-cell in the mesh
      if (!is_at_surface)
        return !CellSimplices<dim>::are_positive(corners);
      // Corners of cells on the surface may be turned over: sub-cells need not be convex.
      const auto mesh_volumes = CellSimplices<dim>::volumes(cells[cell].corners);
      const auto volumes = CellSimplices<dim>::volumes(corners);
      bool result = false;
      for (unsigned int q = 0; q < volumes.size(); ++q)
        result = result || !(volumes[q] > smallest_share * mesh_volumes[q]);
      return result;
    }

    /** Empties thin cells, or shortens the way of their nodes, or holds them. Collective. */
    void relax_thin_cells(const std::vector<bool> &is_thin, Search &search)
    {
      constexpr double most_to_empty = 0.8, smallest_share = 0.1;
      std::vector<bool> may_change = changeable_cells(search), stays = is_thin;
      double has_changed = 0;
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (is_thin[c] && may_change[c] && filling->share(c) > 0. &&
            filling->share(c) < most_to_empty)
        {
          filling->discard(c);
          stays[c] = false;
          has_changed = 1.;
        }
      const auto &partition = search.held.partition();
      const NodalVector marks = CellMarks::nodes_of(partition, local_nodes, stays);
      search.held.fill(
          [&](const unsigned int i, double *const is_held)
          {
            double &share = *search.way_shares.node(i);
            if (!(*marks.node(i) > 0.) || *search.on_surface.node(i) == 0.)
              return;
            has_changed = 1.;
            if (share == 0.)
              *is_held = 1.;
            share = share > smallest_share ? 0.5 * share : 0.;
          });
      if (dealii::Utilities::MPI::max(has_changed, partition->communicator()) > 0.)
        return;
      const NodalVector around =
          CellMarks::nodes_of(partition, local_nodes, CellMarks::cells_marked(local_nodes, marks));
      search.held.fill([&](const unsigned int i, double *const is_held)
                       { *is_held = std::max(*is_held, *around.node(i)); });
    }

    void find_end_of_void(const Model<dim> &model)
    {
      const auto &partition = model.state.partition();
      const dealii::IndexSet prescribed = model.conditions->prescribed_nodes();
      const NodalVector is_held =
          scalar_field(partition, [&](const unsigned int i)
                       { return prescribed.is_element(partition->global_index(i)) ? 1. : 0.; });
      const NodalVector between_sizes = CellMarks::nodes_between_sizes<dim>(cells, partition);
      for (unsigned int c = 0; c < cells.size(); ++c)
      {
        bool is_free = CellMarks::any_marked(local_nodes[c], between_sizes);
        for (unsigned int face = 0; face < dealii::GeometryInfo<dim>::faces_per_cell; ++face)
          for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
            is_free =
                is_free ||
                (cells[c].boundary_ids[face] != dealii::numbers::internal_face_boundary_id &&
                 SubCells<dim>::is_on_face(k, face) && *is_held.node(local_nodes[c][k]) == 0.);
        if (cells[c].is_void && is_free)
          end_of_void.push_back(c);
      }
    }

    /** The cells that can be filled or emptied. */
    std::vector<bool> changeable_cells(const Search &search) const
    {
      std::vector<bool> result = CellMarks::cells_marked(local_nodes, search.held);
      for (std::size_t c = 0; c < cells.size(); ++c)
        result[c] = !result[c] && search.at_surface[c] && !is_at_end[c];
      return result;
    }

    /** The cells of the part with these void ones. Collective. */
    std::vector<SmoothedCell<dim>> cells_with(const Model<dim> &model,
                                              const std::vector<bool> &is_void) const
    {
      VoidCells<dim> changed_voids = voids;
      changed_voids.set(is_void);
      return smoothed_cells_of(mesh_of_part(model, part, &changed_voids));
    }

    /** The ids of the corners of cells, which do not depend on the ranks. Collective. */
    static std::vector<typename CellFilling<dim>::Ids>
    ids_of_corners(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &cells)
    {
      const NodalVector ids =
          scalar_field(model.state.partition(), [&](const unsigned int i)
                       { return static_cast<double>(model.nodes->persistent_ids()[i]); });
      std::vector<typename CellFilling<dim>::Ids> result;
      for (const SmoothedCell<dim> &cell : cells)
      {
        result.emplace_back();
        for (unsigned int k = 0; k < cell.nodes.size(); ++k)
          result.back()[k] = static_cast<std::uint64_t>(
              *ids.node(model.state.partition()->local_index(cell.nodes[k])));
      }
      return result;
    }

    /** The sizes of a cell of the mesh along the axes. */
    static dealii::Tensor<1, dim> sizes_of(const SmoothedCell<dim> &cell)
    {
      dealii::Tensor<1, dim> result = cell.corners.back() - cell.corners.front();
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = std::abs(result[d]);
      return result;
    }

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
