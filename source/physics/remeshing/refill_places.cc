// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/refill_places.h>

#include <tombolo/physics/remeshing/cell_marks.h>
#include <tombolo/physics/remeshing/mesh_of_part.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/corners_at.h>
#include <tombolo/remesh/inner_places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  RefillPlaces<dim>::RefillPlaces(const Model<dim> &model, const unsigned int number,
                                  const SmoothedCells<dim> &of_part, const double end_time)
      : part(of_part), settings(of_part.refill()),
        cells(smoothed_cells_of(mesh_of_part(model, number))), motion(settings)
  {
    motion.corners(cells, end_time, model.communicator);
    if (settings.fills_cells())
    {
      set_partition(*model.state.partition());
      with_void = std::make_unique<FilledPlaces<dim>>(model, number, of_part, local_nodes);
    }
    else if (settings.surface_slides())
      surface = std::make_unique<SurfaceSlide<dim>>(model, cells);
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
                                      const std::vector<unsigned int> &distorted,
                                      const std::vector<double> &volumes)
  {
    std::vector<unsigned int> to_refill = distorted;
    if (with_void)
      with_void->add_displaced_cells(model, clock, motion, to_refill);
    find_free_nodes(model, to_refill);
    if (with_void)
      return with_void->find(model, clock, motion, in_patch, volumes);
    return surface ? find_below_sliding_surface(model, clock) : find_below_held_surface(model);
  }

  template <int dim>
  void RefillPlaces<dim>::find_free_nodes(const Model<dim> &model,
                                          const std::vector<unsigned int> &distorted)
  {
    const auto &partition = model.state.partition();
    std::vector<bool> is_in_patch(cells.size(), false);
    for (const unsigned int cell : distorted)
      is_in_patch[cell] = true;
    in_patch.reinit(partition, Quantity::scalar);
    CellMarks::mark(local_nodes, is_in_patch, true, in_patch);
    for (unsigned int layer = 0; layer < settings.n_layers(); ++layer)
    {
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (CellMarks::any_marked(local_nodes[c], in_patch))
          is_in_patch[c] = true;
      in_patch.reinit(partition, Quantity::scalar);
      CellMarks::mark(local_nodes, is_in_patch, true, in_patch);
    }
    // Nodes of cells that have become particles stay.
    for (unsigned int c = 0; c < cells.size() && !with_void; ++c)
      if (part.is_removed(c))
        is_in_patch[c] = false;
    const NodalVector between_sizes = CellMarks::nodes_between_sizes<dim>(cells, partition);
    NodalVector is_held, of_boundary;
    for (NodalVector *const vector : {&is_held, &of_boundary, &inside, &on_surface})
      vector->reinit(partition, Quantity::scalar);
    CellMarks::mark(local_nodes, is_in_patch, false, is_held);
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
      if (!(*in_patch.node(i) > 0. && *is_held.node(i) == 0.) || *between_sizes.node(i) > 0. ||
          prescribed.is_element(partition->global_index(i)))
        continue;
      if (*of_boundary.node(i) == 0.)
        *inside.node(i) = 1.;
      else if (surface && surface->surface_nodes().is_smooth(i))
        *on_surface.node(i) = 1.;
    }
    on_surface.update_ghosts();
  }

  template <int dim>
  bool RefillPlaces<dim>::is_usable(const unsigned int cell, const NodalVector &before,
                                    const NodalVector &after) const
  {
    const Corners corners = corners_at<dim>(local_nodes[cell], after);
    if (corners == corners_at<dim>(local_nodes[cell], before))
      return true;
    return CellSimplices<dim>::are_positive(corners);
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
    marks.reinit(before.partition(), Quantity::scalar);
    CellMarks::mark(local_nodes, is_unusable, true, marks);
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
      vector->reinit_like(position);
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
    std::vector<Corners> present;
    for (const auto &nodes : local_nodes)
      present.push_back(corners_at<dim>(nodes, position));
    const NodalVector moved = motion.follow(model.state.initial_position, position, clock.time);
    const double way = motion.largest_way(cells, clock.time, model.communicator);
    NodalVector result, stays;
    result.reinit_like(position);
    stays.reinit(position.partition(), Quantity::scalar);
    for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
      *stays.node(i) = *on_surface.node(i) == 0. && *inside.node(i) == 0.;
    for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
    {
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        std::copy_n((*stays.node(i) > 0. ? position : moved).node(i), node_stride, result.node(i));
      result.update_ghosts();
      surface->slide(
          local_nodes, on_surface, mesh_places, position,
          [&](const NodalVector &from, NodalVector &places, NodalVector &is_bound)
          {
            for (const auto &process : model.processes)
              process->keep_outside(clock, on_surface, from, places, is_bound);
          },
          result);
      std::optional<NodalVector> wrong;
      for (const auto &process : model.processes)
      {
        std::vector<double> none;
        if (!wrong && process->find_gaps("", 0., position, {}, clock.time, none))
          wrong = surface->nodes_of_cut_faces(
              local_nodes, on_surface, position, result, way,
              [&](const NodalVector &places, const std::vector<unsigned int> &numbers,
                  std::vector<double> &depths)
              {
                process->find_gaps("", 0., places, numbers, clock.time, depths);
                for (double &depth : depths)
                  depth *= -1.;
              });
      }
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
    all_inside.reinit(position.partition(), Quantity::scalar);
    all_inside.copy_from(inside);
    NodalVector result = slide_surface(model, clock, mesh_places);
    trial.reinit_like(position);
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

  template class RefillPlaces<2>;
  template class RefillPlaces<3>;
} // namespace tombolo
