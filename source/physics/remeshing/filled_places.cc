// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/filled_places.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/mesh_of_part.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/corners_at.h>
#include <tombolo/remesh/inner_places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The ids of the corners of cells, which do not depend on the ranks. Collective. */
    template <int dim>
    std::vector<typename CellFilling<dim>::Ids>
    ids_of_corners(const Model<dim> &model, const std::vector<SmoothedCell<dim>> &cells)
    {
      NodalVector ids;
      ids.reinit(model.state.partition(), 1);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        *ids.node(i) = static_cast<double>(model.nodes->persistent_ids()[i]);
      ids.update_ghosts();
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
  } // namespace

  template <int dim>
  FilledPlaces<dim>::FilledPlaces(const Model<dim> &model, const unsigned int part,
                                  const SmoothedCells<dim> &of_part, const CellNodes &nodes)
      : voids(of_part.void_cells()), local_nodes(nodes), part(part)
  {
    take_void_cells(model);
    for (const SmoothedCell<dim> &cell : cells)
    {
      bool has_end = false;
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
        has_end = has_end || (cell.is_on_boundary[face] && !cell.is_towards_void[face]);
      is_at_end.push_back(has_end);
    }
    filling = std::make_unique<CellFilling<dim>>(ids_of_corners(model, cells), model.communicator);
  }

  template <int dim>
  std::vector<SmoothedCell<dim>>
  FilledPlaces<dim>::cells_with(const Model<dim> &model, const std::vector<bool> &is_void) const
  {
    VoidCells<dim> others = voids;
    others.set(is_void);
    return smoothed_cells_of(mesh_of_part(model, part, &others));
  }

  template <int dim>
  void FilledPlaces<dim>::take_void_cells(const Model<dim> &model)
  {
    cells = smoothed_cells_of(mesh_of_part(model, part, &voids));
    surface = std::make_unique<SurfaceSlide<dim>>(model, cells);
  }

  template <int dim>
  NodalVector FilledPlaces<dim>::nodes_near_surface(const Model<dim> &model) const
  {
    const auto &partition = model.state.partition();
    NodalVector result;
    result.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *result.node(i) = surface->is_on_boundary(i) ? 1. : 0.;
    result.update_ghosts();
    const std::vector<bool> is_near = CellMarks::cells_marked(local_nodes, result);
    result.reinit(partition, 1);
    CellMarks::mark(local_nodes, is_near, true, result);
    return result;
  }

  template <int dim>
  void FilledPlaces<dim>::add_cells_at_void(const Model<dim> &model, const NodalVector &settled,
                                            std::vector<unsigned int> &distorted) const
  {
    constexpr double share_of_size = 0.3;
    const NodalVector &position = model.state.position;
    NodalVector ways; // squared
    ways.reinit(position.partition(), 1);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        *ways.node(i) += std::pow(position.node(i)[d] - settled.node(i)[d], 2);
    ways.update_ghosts();
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      bool has_moved = false;
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
      {
        if (!cells[c].is_towards_void[face])
          continue;
        const Tensor<1, dim> diagonal = cells[c].corners.back() - cells[c].corners.front();
        const double way = share_of_size * std::abs(diagonal[face / 2]);
        for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
          has_moved = has_moved || (((k >> (face / 2)) & 1u) == face % 2 &&
                                    *ways.node(local_nodes[c][k]) > way * way);
      }
      if (has_moved)
        distorted.push_back(c);
    }
  }

  template <int dim>
  typename FilledPlaces<dim>::Search
  FilledPlaces<dim>::begin_search(const Model<dim> &model, const Clock &clock,
                                  const LatticeMotion<dim> &motion, const NodalVector &in_patch)
  {
    const NodalVector &position = model.state.position;
    const auto &partition = position.partition();
    const IndexSet prescribed = model.conditions->prescribed_nodes();
    Search search;
    search.mesh_places = motion.places(model.state.initial_position, clock.time);
    search.mesh = motion.corners(cells, clock.time, model.communicator);
    for (NodalVector *const vector : {&search.in_patch, &search.held, &search.way_shares})
      vector->reinit(partition, 1);
    search.in_patch.copy_from(in_patch);
    search.in_patch.update_ghosts();
    search.near = CellMarks::cells_marked(local_nodes, search.in_patch);
    search.at_surface = CellMarks::cells_marked(local_nodes, nodes_near_surface(model));
    for (std::size_t c = 0; c < cells.size(); ++c)
      search.at_surface[c] = search.at_surface[c] && search.near[c];
    CellMarks::mark(local_nodes, search.near, false, search.held);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      *search.way_shares.node(i) = 1.;
      if (prescribed.is_element(partition->global_index(i)) ||
          (surface->is_on_boundary(i) && !surface->can_slide(i)))
        *search.held.node(i) = 1.;
    }
    search.held.update_ghosts();
    std::vector<Corners> present;
    for (const auto &nodes : local_nodes)
      present.push_back(corners_at<dim>(nodes, position));
    filling->measure(voids.of_cells(), present, search.near, search.mesh, search.at_surface);
    return search;
  }

  template <int dim>
  void FilledPlaces<dim>::classify_nodes(const SurfaceSlide<dim> &next, Search &search) const
  {
    const auto &partition = search.held.partition();
    NodalVector of_full;
    for (NodalVector *const vector : {&of_full, &search.inside, &search.on_surface})
      vector->reinit(partition, 1);
    CellMarks::mark(local_nodes, void_after, false, of_full);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (next.is_on_boundary(i) && !next.can_slide(i))
        *search.held.node(i) = 1.;
      else if (*search.held.node(i) == 0. && *of_full.node(i) > 0.)
        *(next.is_on_boundary(i) ? search.on_surface : search.inside).node(i) = 1.;
    search.held.update_ghosts();
    search.on_surface.update_ghosts();
  }

  template <int dim>
  std::vector<bool> FilledPlaces<dim>::changeable_cells(const Search &search) const
  {
    std::vector<bool> result = CellMarks::cells_marked(local_nodes, search.held);
    for (std::size_t c = 0; c < cells.size(); ++c)
      result[c] = !result[c] && search.at_surface[c] && !is_at_end[c];
    return result;
  }

  template <int dim>
  NodalVector FilledPlaces<dim>::try_places(const Model<dim> &model, const Clock &clock,
                                            Search &search)
  {
    const NodalVector &position = model.state.position;
    void_after = filling->choose(voids.of_cells(), search.near, changeable_cells(search));
    const SurfaceSlide<dim> next(model, cells_with(model, void_after));
    classify_nodes(next, search);
    NodalVector result;
    result.reinit(position.partition(), node_stride, position.under_reflection());
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      std::copy_n((*search.held.node(i) > 0. ? position : search.mesh_places).node(i), node_stride,
                  result.node(i));
    result.update_ghosts();
    next.slide_onto(
        *surface, search.in_patch, search.volume, local_nodes, search.on_surface, search.way_shares,
        search.mesh_places, position,
        [&](NodalVector &places, NodalVector &is_bound)
        {
          for (const auto &process : model.processes)
            process->keep_outside(clock, search.on_surface, position, places, is_bound);
        },
        result);
    place_inner_nodes<dim>(local_nodes, search.mesh, search.inside, search.mesh_places, result);
    return result;
  }

  template <int dim>
  NodalVector FilledPlaces<dim>::find(const Model<dim> &model, const Clock &clock,
                                      const LatticeMotion<dim> &motion, const NodalVector &in_patch,
                                      const std::vector<double> &volumes)
  {
    constexpr unsigned int most_attempts = 20;
    const NodalVector &position = model.state.position;
    Search search = begin_search(model, clock, motion, in_patch);
    for (std::size_t c = 0; c < cells.size(); ++c)
      search.volume += search.near[c] ? volumes[c] : 0.;
    search.volume = ordered_sum(search.volume, model.communicator);
    for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
    {
      NodalVector result = try_places(model, clock, search);
      const auto is_thin = thin_cells(position, result, search);
      if (!is_thin)
        return result;
      mend(*is_thin, search);
    }
    void_after = voids.of_cells();
    NodalVector result;
    result.reinit(position.partition(), node_stride, position.under_reflection());
    result.copy_from(position);
    result.update_ghosts();
    return result;
  }

  template <int dim>
  bool FilledPlaces<dim>::is_thin(const std::size_t cell, const Corners &corners,
                                  const bool is_at_surface) const
  {
    constexpr double smallest_share = 0.12; // of the volume of a sub-cell in the mesh
    if (!is_at_surface)
      return !CellSimplices<dim>::are_positive(corners);
    // Corners of cells on the surface may be turned over: sub-cells need not be convex.
    const auto of_mesh = CellSimplices<dim>::volumes(cells[cell].corners);
    const auto volumes = CellSimplices<dim>::volumes(corners);
    bool result = false;
    for (unsigned int q = 0; q < volumes.size(); ++q)
      result = result || !(volumes[q] > smallest_share * of_mesh[q]);
    return result;
  }

  template <int dim>
  std::optional<std::vector<bool>> FilledPlaces<dim>::thin_cells(const NodalVector &before,
                                                                 const NodalVector &after,
                                                                 const Search &search) const
  {
    std::vector<bool> result(cells.size(), false);
    bool any = false;
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      const Corners corners = corners_at<dim>(local_nodes[c], after);
      const bool stays = !voids.of_cells()[c] && corners == corners_at<dim>(local_nodes[c], before);
      result[c] = !void_after[c] && !stays && is_thin(c, corners, search.at_surface[c]);
      any = any || result[c];
    }
    if (Utilities::MPI::max(any ? 1 : 0, before.partition()->communicator()) == 0)
      return {};
    return result;
  }

  template <int dim>
  void FilledPlaces<dim>::mend(const std::vector<bool> &is_thin, Search &search)
  {
    constexpr double most_to_empty = 0.8, smallest_share = 0.1;
    const MPI_Comm communicator = search.held.partition()->communicator();
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
    NodalVector marks;
    marks.reinit(search.held.partition(), 1);
    CellMarks::mark(local_nodes, stays, true, marks);
    for (unsigned int i = 0; i < marks.partition()->n_owned(); ++i)
    {
      double &share = *search.way_shares.node(i);
      if (!(*marks.node(i) > 0.) || *search.on_surface.node(i) == 0.)
        continue;
      has_changed = 1.;
      if (share == 0.)
        *search.held.node(i) = 1.;
      share = share > smallest_share ? 0.5 * share : 0.;
    }
    search.held.update_ghosts();
    if (Utilities::MPI::max(has_changed, communicator) == 0.)
      CellMarks::mark(local_nodes, CellMarks::cells_marked(local_nodes, marks), true, search.held);
  }

  template class FilledPlaces<2>;
  template class FilledPlaces<3>;
} // namespace tombolo
