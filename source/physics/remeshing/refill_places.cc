// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/refill_places.h>

#include <tombolo/model/gap_source.h>
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
    template <int dim>
    PartSetup<dim> mesh_of_part(const Model<dim> &model, const unsigned int part,
                                const VoidCells<dim> &voids)
    {
      PartSetup<dim> setup;
      setup.void_cells = voids.is_on() ? &voids : nullptr;
      setup.index = part;
      setup.nodes = model.nodes.get();
      setup.part_cells = model.part_cells.get();
      return setup;
    }

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
  RefillPlaces<dim>::RefillPlaces(const Model<dim> &model, const unsigned int part,
                                  const SmoothedCells<dim> &of_part, const double end_time)
      : settings(of_part.refill()), voids(of_part.void_cells()), part(part), motion(settings)
  {
    take_void_cells(model);
    motion.corners(cells, end_time, model.communicator);
    if (voids.is_on())
      filling =
          std::make_unique<CellFilling<dim>>(ids_of_corners(model, cells), model.communicator);
  }

  template <int dim>
  void RefillPlaces<dim>::take_void_cells(const Model<dim> &model)
  {
    cells = smoothed_cells_of(mesh_of_part(model, part, voids));
    if (settings.surface_slides())
      surface = std::make_unique<SurfaceSlide<dim>>(model, part, cells);
  }

  template <int dim>
  std::vector<SmoothedCell<dim>>
  RefillPlaces<dim>::cells_with(const Model<dim> &model, const std::vector<bool> &is_void) const
  {
    VoidCells<dim> others = voids;
    others.set(is_void);
    return smoothed_cells_of(mesh_of_part(model, part, others));
  }

  template <int dim>
  void RefillPlaces<dim>::set_partition(const NodePartition &partition)
  {
    local_nodes.resize(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
        local_nodes[c][k] = partition.local_index(cells[c].nodes[k]);
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::find(const Model<dim> &model, const Clock &clock,
                                      const std::vector<unsigned int> &distorted)
  {
    find_free_nodes(model, distorted);
    if (voids.is_on())
      return find_with_void_cells(model, clock);
    return surface ? find_below_sliding_surface(model, clock) : find_below_held_surface(model);
  }

  template <int dim>
  void RefillPlaces<dim>::mark_nodes(const std::vector<bool> &is_chosen, const bool of_chosen,
                                     NodalVector &marks) const
  {
    for (std::size_t c = 0; c < local_nodes.size(); ++c)
      if (is_chosen[c] == of_chosen)
        for (const unsigned int node : local_nodes[c])
          *marks.node(node) = 1.;
    marks.add_to_owners();
    marks.update_ghosts();
  }

  template <int dim>
  void RefillPlaces<dim>::find_free_nodes(const Model<dim> &model,
                                          const std::vector<unsigned int> &distorted)
  {
    const auto &partition = model.state.partition();
    std::vector<bool> is_in_patch(cells.size(), false);
    for (const unsigned int cell : distorted)
      is_in_patch[cell] = true;
    in_patch.reinit(partition, 1);
    mark_nodes(is_in_patch, true, in_patch);
    for (unsigned int layer = 0; layer < settings.n_layers(); ++layer)
    {
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (std::any_of(local_nodes[c].begin(), local_nodes[c].end(),
                        [&](const unsigned int node) { return *in_patch.node(node) > 0.; }))
          is_in_patch[c] = true;
      in_patch.reinit(partition, 1);
      mark_nodes(is_in_patch, true, in_patch);
    }
    NodalVector is_held, of_boundary;
    for (NodalVector *const vector : {&is_held, &of_boundary, &inside, &on_surface})
      vector->reinit(partition, 1);
    mark_nodes(is_in_patch, false, is_held);
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
        if (cells[c].is_on_boundary[face])
          for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
            if (((k >> (face / 2)) & 1u) == face % 2)
              *of_boundary.node(local_nodes[c][k]) = 1.;
    of_boundary.add_to_owners();
    const IndexSet prescribed = model.conditions->prescribed_nodes();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      if (!(*in_patch.node(i) > 0. && *is_held.node(i) == 0.) ||
          prescribed.is_element(partition->global_index(i)))
        continue;
      if (*of_boundary.node(i) == 0.)
        *inside.node(i) = 1.;
      else if (surface && surface->can_slide(i))
        *on_surface.node(i) = 1.;
    }
    on_surface.update_ghosts();
  }

  template <int dim>
  bool RefillPlaces<dim>::is_usable(const unsigned int cell, const NodalVector &before,
                                    const NodalVector &after) const
  {
    const Corners corners = corners_at<dim>(local_nodes[cell], after);
    const bool was_void = voids.is_on() && voids.of_cells()[cell];
    if ((!void_after.empty() && void_after[cell]) ||
        (!was_void && corners == corners_at<dim>(local_nodes[cell], before)))
      return true;
    const auto &all = CellSimplices<dim>::all();
    return std::all_of(all.begin(), all.end(),
                       [&](const auto &simplex) {
                         return CellSimplices<dim>::volume(
                                    CellSimplices<dim>::vertices(simplex, corners)) > 0.;
                       });
  }

  template <int dim>
  std::optional<NodalVector>
  RefillPlaces<dim>::nodes_of_unusable_cells(const NodalVector &before,
                                             const NodalVector &after) const
  {
    std::vector<bool> is_unusable(local_nodes.size());
    bool any = false;
    for (unsigned int cell = 0; cell < local_nodes.size(); ++cell)
    {
      is_unusable[cell] = !is_usable(cell, before, after);
      any = any || is_unusable[cell];
    }
    if (Utilities::MPI::max(any ? 1 : 0, before.partition()->communicator()) == 0)
      return {};
    NodalVector marks;
    marks.reinit(before.partition(), 1);
    mark_nodes(is_unusable, true, marks);
    return marks;
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::find_below_held_surface(const Model<dim> &model) const
  {
    constexpr double smallest_share = 0.1;
    const NodalVector &position = model.state.position;
    std::vector<Corners> initial;
    for (const SmoothedCell<dim> &cell : cells)
      initial.push_back(cell.corners);
    NodalVector target, result;
    for (NodalVector *const vector : {&target, &result})
    {
      vector->reinit(position.partition(), node_stride, position.under_reflection());
      vector->copy_from(position);
    }
    place_inner_nodes<dim>(local_nodes, initial, inside, model.state.initial_position, target);
    for (double share = 1.; share > smallest_share; share *= 0.5)
    {
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        if (*inside.node(i) > 0.)
          for (unsigned int d = 0; d < dim; ++d)
            result.node(i)[d] = share * target.node(i)[d] + (1. - share) * position.node(i)[d];
      result.update_ghosts();
      if (!nodes_of_unusable_cells(position, result))
        return result;
    }
    result.copy_from(position);
    return result;
  }

  template <int dim>
  void RefillPlaces<dim>::hold_nodes(const NodalVector &marks, const bool only_on_surface,
                                     NodalVector &stays)
  {
    for (unsigned int i = 0; i < stays.partition()->n_owned(); ++i)
    {
      double &slides = *on_surface.node(i);
      if (!(*marks.node(i) > 0.) || *stays.node(i) > 0. || (only_on_surface && slides == 0.))
        continue;
      const bool was_free = slides == SurfaceSlide<dim>::relaxes || *inside.node(i) > 0.;
      *inside.node(i) = 0.;
      if (motion.is_on() && was_free)
        slides = slides > 0. ? SurfaceSlide<dim>::goes_with_mesh : 0.;
      else
      {
        slides = 0.;
        *stays.node(i) = 1.;
      }
    }
    on_surface.update_ghosts();
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::slide_surface(const Model<dim> &model, const Clock &clock,
                                               const NodalVector &mesh_places)
  {
    constexpr unsigned int most_attempts = 20;
    const NodalVector &position = model.state.position;
    const auto *const gaps = model.template find_process<GapSource>();
    std::vector<Corners> present;
    for (const auto &nodes : local_nodes)
      present.push_back(corners_at<dim>(nodes, position));
    const NodalVector moved = motion.follow(model.state.initial_position, position, clock.time);
    const double way = motion.largest_way(cells, clock.time, model.communicator);
    NodalVector result, stays;
    result.reinit(position.partition(), node_stride, position.under_reflection());
    stays.reinit(position.partition(), 1);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      *stays.node(i) = *on_surface.node(i) == 0. && *inside.node(i) == 0.;
    for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
    {
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        std::copy_n((*stays.node(i) > 0. ? position : moved).node(i), node_stride, result.node(i));
      result.update_ghosts();
      surface->slide(
          local_nodes, on_surface, mesh_places, position,
          [&](NodalVector &places, NodalVector &is_bound)
          {
            for (const auto &process : model.processes)
              process->keep_outside(clock, on_surface, position, places, is_bound);
          },
          result);
      std::optional<NodalVector> wrong;
      if (gaps != nullptr)
        wrong = surface->nodes_of_cut_faces(
            local_nodes, on_surface, position, result, way,
            [&](const NodalVector &places, const std::vector<unsigned int> &numbers,
                std::vector<double> &depths)
            { gaps->find_depths(places, numbers, clock.time, depths); });
      const bool is_cut = wrong.has_value();
      if (!is_cut)
      {
        place_inner_nodes<dim>(local_nodes, present, inside, moved, result);
        wrong = nodes_of_unusable_cells(position, result);
      }
      if (!wrong)
        return result;
      hold_nodes(*wrong, is_cut, stays);
    }
    on_surface.set_zero();
    result.copy_from(position);
    return result;
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::find_below_sliding_surface(const Model<dim> &model,
                                                            const Clock &clock)
  {
    constexpr unsigned int n_steps = 8, most_attempts = 10;
    const NodalVector &position = model.state.position;
    const std::size_t n_values = std::size_t(position.partition()->n_owned()) * node_stride;
    const NodalVector mesh_places = motion.places(model.state.initial_position, clock.time);
    const std::vector<Corners> of_lattice = motion.corners(cells, clock.time, model.communicator);
    NodalVector all_inside, trial;
    all_inside.reinit(position.partition(), 1);
    all_inside.copy_from(inside);
    NodalVector result = slide_surface(model, clock, mesh_places);
    trial.reinit(position.partition(), node_stride, position.under_reflection());
    for (unsigned int step = 0; step < n_steps; ++step)
    {
      NodalVector way = winslow_step<dim>(local_nodes, of_lattice, all_inside, mesh_places, result);
      bool is_possible = false;
      for (unsigned int attempt = 0; attempt < most_attempts && !is_possible; ++attempt)
      {
        for (std::size_t i = 0; i < n_values; ++i)
          trial.data()[i] = result.data()[i] + way.data()[i];
        trial.update_ghosts();
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
    }
    return result;
  }

  template <int dim>
  std::vector<typename RefillPlaces<dim>::Corners>
  RefillPlaces<dim>::corners_of_cells(const NodalVector &position) const
  {
    std::vector<Corners> result;
    for (const auto &nodes : local_nodes)
      result.push_back(corners_at<dim>(nodes, position));
    return result;
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::nodes_near_surface(const Model<dim> &model) const
  {
    const auto &partition = model.state.partition();
    NodalVector result;
    result.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *result.node(i) = surface->is_on_boundary(i) ? 1. : 0.;
    result.update_ghosts();
    std::vector<bool> is_near(cells.size(), false);
    for (std::size_t c = 0; c < cells.size(); ++c)
      is_near[c] = std::any_of(local_nodes[c].begin(), local_nodes[c].end(),
                               [&](const unsigned int node) { return *result.node(node) > 0.; });
    result.reinit(partition, 1);
    mark_nodes(is_near, true, result);
    return result;
  }

  template <int dim>
  void RefillPlaces<dim>::add_cells_at_void(const Model<dim> &model, const NodalVector &reference,
                                            std::vector<unsigned int> &distorted) const
  {
    constexpr double share_of_size = 0.3;
    const NodalVector &position = model.state.position;
    NodalVector ways; // squared
    ways.reinit(position.partition(), 1);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        *ways.node(i) += std::pow(position.node(i)[d] - reference.node(i)[d], 2);
    ways.update_ghosts();
    for (unsigned int c = 0; c < cells.size(); ++c)
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
      {
        if (!cells[c].is_towards_void[face])
          continue;
        const double size =
            std::abs((cells[c].corners.back() - cells[c].corners.front())[face / 2]);
        for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
          if (((k >> (face / 2)) & 1u) == face % 2 &&
              *ways.node(local_nodes[c][k]) > std::pow(share_of_size * size, 2))
          {
            distorted.push_back(c);
            break;
          }
      }
  }

  template <int dim>
  void RefillPlaces<dim>::classify_nodes(const Model<dim> &model, const SurfaceSlide<dim> &next,
                                         const NodalVector &held)
  {
    const auto &partition = model.state.partition();
    NodalVector of_full;
    for (NodalVector *const vector : {&of_full, &inside, &on_surface})
      vector->reinit(partition, 1);
    mark_nodes(void_after, false, of_full);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*held.node(i) == 0. && *of_full.node(i) > 0.)
        *(next.is_on_boundary(i) ? on_surface : inside).node(i) = 1.;
    on_surface.update_ghosts();
  }

  template <int dim>
  NodalVector RefillPlaces<dim>::find_with_void_cells(const Model<dim> &model, const Clock &clock)
  {
    constexpr unsigned int most_attempts = 20;
    const NodalVector &position = model.state.position;
    const auto &partition = position.partition();
    const NodalVector mesh_places = motion.places(model.state.initial_position, clock.time);
    const std::vector<Corners> of_lattice = motion.corners(cells, clock.time, model.communicator);
    const IndexSet prescribed = model.conditions->prescribed_nodes();
    const NodalVector near_surface = nodes_near_surface(model);
    NodalVector held, result;
    held.reinit(partition, 1);
    result.reinit(partition, node_stride, position.under_reflection());
    std::vector<bool> near(cells.size()), may_change(cells.size()), wanted(cells.size());
    const auto any_of = [this](const std::size_t c, const NodalVector &marks)
    {
      return std::any_of(local_nodes[c].begin(), local_nodes[c].end(),
                         [&](const unsigned int node) { return *marks.node(node) > 0.; });
    };
    for (std::size_t c = 0; c < cells.size(); ++c)
    {
      near[c] = any_of(c, in_patch);
      wanted[c] = near[c] && any_of(c, near_surface);
    }
    mark_nodes(near, false, held); // the rim
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (prescribed.is_element(partition->global_index(i)) ||
          (surface->is_on_boundary(i) && !surface->can_slide(i)))
        *held.node(i) = 1.;
    held.update_ghosts();
    filling->measure(voids.of_cells(), corners_of_cells(position), near, of_lattice, wanted);
    const auto *const gaps = model.template find_process<GapSource>();
    const double way = motion.largest_way(cells, clock.time, model.communicator);
    for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
    {
      for (std::size_t c = 0; c < cells.size(); ++c)
        may_change[c] = wanted[c] && !any_of(c, held);
      void_after = filling->choose(voids.of_cells(), near, may_change);
      const SurfaceSlide<dim> next(model, part, cells_with(model, void_after));
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (next.is_on_boundary(i) && !next.can_slide(i))
          *held.node(i) = 1.;
      held.update_ghosts();
      classify_nodes(model, next, held);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        std::copy_n((*held.node(i) > 0. ? position : mesh_places).node(i), node_stride,
                    result.node(i));
      result.update_ghosts();
      next.slide_onto(
          *surface, in_patch, local_nodes, on_surface, mesh_places, position,
          [&](NodalVector &places, NodalVector &is_bound)
          {
            for (const auto &process : model.processes)
              process->keep_outside(clock, on_surface, position, places, is_bound);
          },
          result);
      std::optional<NodalVector> wrong;
      if (gaps != nullptr)
        wrong = next.nodes_of_cut_faces(
            local_nodes, on_surface, position, result, way,
            [&](const NodalVector &places, const std::vector<unsigned int> &numbers,
                std::vector<double> &depths)
            { gaps->find_depths(places, numbers, clock.time, depths); });
      if (!wrong)
      {
        place_inner_nodes<dim>(local_nodes, of_lattice, inside, mesh_places, result);
        wrong = nodes_of_unusable_cells(position, result);
      }
      if (!wrong)
        return result;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*wrong->node(i) > 0.)
          *held.node(i) = 1.;
      held.update_ghosts();
    }
    void_after = voids.of_cells();
    for (NodalVector *const vector : {&inside, &on_surface})
      vector->reinit(partition, 1);
    result.copy_from(position);
    return result;
  }

  template class RefillPlaces<2>;
  template class RefillPlaces<3>;
} // namespace tombolo
