// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/part_refill.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/model/gap_source.h>
#include <tombolo/model/persistent_cell_ids.h>
#include <tombolo/remesh/inner_places.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    // Of the way to a place; nodes that cannot go more of it stay.
    constexpr double smallest_share = 0.1;

    template <int dim>
    PartSetup<dim> mesh_of_part(const Model<dim> &model, const unsigned int part)
    {
      PartSetup<dim> setup;
      setup.index = part;
      setup.nodes = model.nodes.get();
      setup.part_cells = model.part_cells.get();
      return setup;
    }

    template <int dim>
    typename SubCells<dim>::Corners
    corners_at(const std::array<unsigned int, SubCells<dim>::n_corners> &nodes,
               const NodalVector &position)
    {
      typename SubCells<dim>::Corners result;
      for (unsigned int k = 0; k < nodes.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          result[k][d] = position.node(nodes[k])[d];
      return result;
    }
  } // namespace

  template <int dim>
  PartRefill<dim>::PartRefill(const Model<dim> &model, const unsigned int part,
                              SmoothedCells<dim> &cells)
      : part(part), cells(cells), lattice(smoothed_cells_of(mesh_of_part(model, part)))
  {
    if (cells.refill().surface_slides())
      surface = std::make_unique<SurfaceSlide<dim>>(model, part, lattice);
  }

  template <int dim>
  bool PartRefill<dim>::refill(Model<dim> &model, const Clock &clock)
  {
    const std::vector<unsigned int> distorted = cells.distorted_cells(model.state.position);
    if (Utilities::MPI::max(distorted.empty() ? 0 : 1, model.communicator) == 0)
      return false;
    const NodePartition &partition = *model.state.partition();
    local_nodes.resize(lattice.size());
    for (std::size_t c = 0; c < lattice.size(); ++c)
      for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
        local_nodes[c][k] = partition.local_index(lattice[c].nodes[k]);
    FreeNodes is_free = find_free_nodes(model, distorted);
    const NodalVector places = find_places(model, is_free, clock);
    try
    {
      cells.renew_reference(places);
    }
    catch (const InputError &)
    {
      return false; // all ranks; the part goes on as it is
    }
    model.begin_change();
    remap(model, places, is_free.surface, clock);
    ++count;
    return true;
  }

  template <int dim>
  void PartRefill<dim>::mark_nodes(const std::vector<bool> &is_in_patch, const bool of_patch,
                                   NodalVector &marks) const
  {
    for (std::size_t c = 0; c < lattice.size(); ++c)
      if (is_in_patch[c] == of_patch)
        for (const unsigned int node : local_nodes[c])
          *marks.node(node) = 1.;
    marks.add_to_owners();
    marks.update_ghosts();
  }

  template <int dim>
  typename PartRefill<dim>::FreeNodes
  PartRefill<dim>::find_free_nodes(const Model<dim> &model,
                                   const std::vector<unsigned int> &distorted)
  {
    const auto &partition = model.state.partition();
    std::vector<bool> is_in_patch(lattice.size(), false);
    for (const unsigned int cell : distorted)
      is_in_patch[cell] = true;
    in_patch.reinit(partition, 1);
    mark_nodes(is_in_patch, true, in_patch);
    for (unsigned int layer = 0; layer < cells.refill().n_layers(); ++layer)
    {
      for (std::size_t c = 0; c < lattice.size(); ++c)
        if (std::any_of(local_nodes[c].begin(), local_nodes[c].end(),
                        [&](const unsigned int node) { return *in_patch.node(node) > 0.; }))
          is_in_patch[c] = true;
      in_patch.reinit(partition, 1);
      mark_nodes(is_in_patch, true, in_patch);
    }
    NodalVector is_held, of_boundary;
    FreeNodes result;
    for (NodalVector *const vector : {&is_held, &of_boundary, &result.inside, &result.surface})
      vector->reinit(partition, 1);
    mark_nodes(is_in_patch, false, is_held);
    for (std::size_t c = 0; c < lattice.size(); ++c)
      for (unsigned int face = 0; face < GeometryInfo<dim>::faces_per_cell; ++face)
        if (lattice[c].is_on_boundary[face])
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
        *result.inside.node(i) = 1.;
      else if (surface && surface->can_slide(i))
        *result.surface.node(i) = 1.;
    }
    result.surface.update_ghosts();
    return result;
  }

  template <int dim>
  bool PartRefill<dim>::is_usable(const unsigned int cell, const NodalVector &before,
                                  const NodalVector &after) const
  {
    const Corners corners = corners_at<dim>(local_nodes[cell], after);
    if (corners == corners_at<dim>(local_nodes[cell], before))
      return true;
    const auto &all = CellSimplices<dim>::all();
    return std::all_of(all.begin(), all.end(),
                       [&](const auto &simplex)
                       {
                         return CellSimplices<dim>::volume(
                                    CellSimplices<dim>::vertices(simplex, corners)) > 0.;
                       });
  }

  template <int dim>
  bool PartRefill<dim>::are_cells_usable(const NodalVector &before, const NodalVector &after) const
  {
    for (unsigned int cell = 0; cell < local_nodes.size(); ++cell)
      if (!is_usable(cell, before, after))
        return false;
    return true;
  }

  template <int dim>
  std::optional<NodalVector>
  PartRefill<dim>::nodes_of_unusable_cells(const NodalVector &before,
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
  NodalVector PartRefill<dim>::find_places(const Model<dim> &model, FreeNodes &is_free,
                                           const Clock &clock) const
  {
    if (surface)
      return find_places_below_surface(model, is_free, clock);
    const NodalVector &position = model.state.position;
    std::vector<Corners> initial;
    for (const SmoothedCell<dim> &cell : lattice)
      initial.push_back(cell.corners);
    NodalVector target, result;
    for (NodalVector *const vector : {&target, &result})
    {
      vector->reinit(position.partition(), node_stride, position.under_reflection());
      vector->copy_from(position);
    }
    place_inner_nodes<dim>(local_nodes, initial, is_free.inside, model.state.initial_position,
                           target);
    for (double share = 1.; share > smallest_share; share *= 0.5)
    {
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        if (*is_free.inside.node(i) > 0.)
          for (unsigned int d = 0; d < dim; ++d)
            result.node(i)[d] = share * target.node(i)[d] + (1. - share) * position.node(i)[d];
      result.update_ghosts();
      if (Utilities::MPI::min(are_cells_usable(position, result) ? 1 : 0, model.communicator) == 1)
        return result;
    }
    result.copy_from(position);
    return result;
  }

  template <int dim>
  NodalVector PartRefill<dim>::slide_surface(const Model<dim> &model, FreeNodes &is_free,
                                             const Clock &clock) const
  {
    constexpr unsigned int most_attempts = 20;
    const NodalVector &position = model.state.position;
    const auto *const gaps = model.template find_process<GapSource>();
    std::vector<Corners> present;
    for (const auto &nodes : local_nodes)
      present.push_back(corners_at<dim>(nodes, position));
    NodalVector result;
    result.reinit(position.partition(), node_stride, position.under_reflection());
    for (unsigned int attempt = 0; attempt < most_attempts; ++attempt)
    {
      result.copy_from(position);
      surface->slide(
          local_nodes, is_free.surface, model.state.initial_position, position,
          [&](NodalVector &places, NodalVector &is_bound)
          {
            for (const auto &process : model.processes)
              process->keep_outside(clock, is_free.surface, position, places, is_bound);
          },
          result);
      if (gaps != nullptr)
        if (const auto cut = surface->nodes_of_cut_faces(
                local_nodes, is_free.surface, position, result,
                [&](const NodalVector &places, const std::vector<unsigned int> &numbers,
                    std::vector<double> &depths)
                { gaps->find_depths(places, numbers, clock.time, depths); }))
        {
          for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
            if (*cut->node(i) > 0.)
              *is_free.surface.node(i) = 0.;
          is_free.surface.update_ghosts();
          continue;
        }
      place_inner_nodes<dim>(local_nodes, present, is_free.inside, position, result);
      const auto unusable = nodes_of_unusable_cells(position, result);
      if (!unusable)
        return result;
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        if (*unusable->node(i) > 0.)
          *is_free.surface.node(i) = *is_free.inside.node(i) = 0.;
      is_free.surface.update_ghosts();
    }
    is_free.surface.set_zero();
    result.copy_from(position);
    return result;
  }

  template <int dim>
  NodalVector PartRefill<dim>::find_places_below_surface(const Model<dim> &model,
                                                         FreeNodes &is_free,
                                                         const Clock &clock) const
  {
    constexpr unsigned int n_steps = 8, most_attempts = 10;
    const NodalVector &position = model.state.position;
    const std::size_t n_values = std::size_t(position.partition()->n_owned()) * node_stride;
    std::vector<Corners> of_lattice;
    for (const SmoothedCell<dim> &cell : lattice)
      of_lattice.push_back(cell.corners);
    NodalVector inside, trial;
    inside.reinit(position.partition(), 1);
    inside.copy_from(is_free.inside);
    NodalVector result = slide_surface(model, is_free, clock);
    trial.reinit(position.partition(), node_stride, position.under_reflection());
    for (unsigned int step = 0; step < n_steps; ++step)
    {
      NodalVector way = winslow_step<dim>(local_nodes, of_lattice, inside,
                                          model.state.initial_position, result);
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
  std::vector<RemapCell<dim>> PartRefill<dim>::remap_cells(const NodalVector &before,
                                                           const NodalVector &after,
                                                           const NodalVector &slides) const
  {
    std::vector<RemapCell<dim>> result(local_nodes.size());
    for (std::size_t c = 0; c < local_nodes.size(); ++c)
    {
      result[c].nodes = local_nodes[c];
      result[c].before = corners_at<dim>(local_nodes[c], before);
      result[c].after = corners_at<dim>(local_nodes[c], after);
      for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
        result[c].is_cut = result[c].is_cut || (*slides.node(local_nodes[c][k]) > 0. &&
                                                result[c].before[k] != result[c].after[k]);
    }
    return result;
  }

  template <int dim>
  PointValues PartRefill<dim>::get_points(std::vector<RemapCell<dim>> &remapped)
  {
    const SmoothedPointState<dim> state = cells.point_state();
    PointValues result;
    result.n_components = state.n_components();
    result.stress = 0;
    if (point_mass.empty())
      for (unsigned int c = 0; c < remapped.size(); ++c)
        for (unsigned int q = 0; q < SubCells<dim>::n_sub_cells; ++q)
          point_mass.push_back(state.mass(cells.point_of_cell(c, q)));
    result.mass = point_mass;
    result.values.resize(remapped.size() * SubCells<dim>::n_sub_cells * result.n_components);
    double *values = result.values.data();
    for (unsigned int c = 0; c < remapped.size(); ++c)
      for (unsigned int q = 0; q < SubCells<dim>::n_sub_cells; ++q, values += result.n_components)
      {
        const double mass = point_mass[std::size_t(c) * SubCells<dim>::n_sub_cells + q];
        remapped[c].mass[q] = mass;
        state.get(cells.point_of_cell(c, q), mass, values);
      }
    return result;
  }

  template <int dim>
  void PartRefill<dim>::set_points(const std::vector<RemapCell<dim>> &remapped,
                                   const PointValues &points, const NodalVector &velocity,
                                   const double step)
  {
    SmoothedPointState<dim> state = cells.point_state();
    const double *values = points.values.data();
    for (unsigned int c = 0; c < remapped.size(); ++c)
    {
      // The state is that of t_{n-1}, and the step to t_n is still to come.
      const auto volumes = CellSimplices<dim>::volumes(remapped[c].after);
      Corners former = remapped[c].after;
      for (unsigned int k = 0; k < former.size(); ++k)
        for (unsigned int d = 0; d < dim; ++d)
          former[k][d] -= step * velocity.node(remapped[c].nodes[k])[d];
      double now = 0, before = 0;
      for (const double volume : volumes)
        now += volume;
      for (const double volume : CellSimplices<dim>::volumes(former))
        before += volume;
      for (unsigned int q = 0; q < SubCells<dim>::n_sub_cells; ++q, values += points.n_components)
        state.set(cells.point_of_cell(c, q),
                  points.mass[std::size_t(c) * SubCells<dim>::n_sub_cells + q],
                  volumes[q] * before / now, values);
    }
    point_mass = points.mass;
    state.fill_unused_lanes();
  }

  template <int dim>
  NodalVector PartRefill<dim>::own_mass(const std::shared_ptr<const NodePartition> &partition) const
  {
    NodalVector result;
    result.reinit(partition, 1);
    const std::vector<double> masses = cells.masses_of_cells();
    for (std::size_t c = 0; c < local_nodes.size(); ++c)
      for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
        *result.node(local_nodes[c][k]) += masses[c * local_nodes[c].size() + k];
    result.add_to_owners();
    return result;
  }

  template <int dim>
  void PartRefill<dim>::set_masses(const CellOverlap<dim> &overlap,
                                   const std::vector<double> &of_points)
  {
    constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    std::vector<double> masses = cells.masses_of_cells();
    const std::vector<double> gained =
        surface ? std::vector<double>(masses.size(), 0.) : gained_masses(overlap);
    for (std::size_t i = 0; i < masses.size(); ++i)
      masses[i] += gained[i];
    for (std::size_t c = 0; surface && c < overlap.cells.size(); ++c)
      if (overlap.cells[c].has_moved())
      {
        const auto of_corners = masses_of_corners<dim>(
            overlap.cells[c].after, of_points.data() + c * SubCells<dim>::n_sub_cells);
        std::copy(of_corners.begin(), of_corners.end(),
                  masses.begin() + std::ptrdiff_t(c * n_corners));
      }
    cells.set_masses(masses);
  }

  template <int dim>
  void PartRefill<dim>::remap(Model<dim> &model, const NodalVector &places,
                              const NodalVector &slides, const Clock &clock)
  {
    NodalState &state = model.state;
    const auto partition = state.partition();
    std::vector<RemapCell<dim>> remapped = remap_cells(state.position, places, slides);
    PointValues points = get_points(remapped);
    NodalVector mass, inertia, heat, heat_before;
    mass.reinit(partition, 1);
    mass.copy_from(own_mass(partition));
    inertia.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      *inertia.node(i) = *model.bridge->mass().node(i) / model.inertia_factor;
    std::vector<const NodalVector *> fields(1, &state.unsmoothed_velocity);
    state.unsmoothed_velocity.update_ghosts();
    if (model.heat)
    {
      for (NodalVector *const vector : {&heat, &heat_before})
        vector->reinit(partition, node_stride, ReflectionParity::even);
      const ThermalState &thermal = model.heat->state;
      const ThermalProperties &properties = *model.parts[part].heat;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (*mass.node(i) > 0.)
        {
          heat.node(i)[0] = properties.enthalpy(*thermal.unsmoothed_temperature.node(i));
          heat.node(i)[1] = properties.enthalpy(*thermal.next_unsmoothed_temperature.node(i));
          heat.node(i)[2] = properties.enthalpy(*thermal.present_temperature.node(i));
        }
      heat.update_ghosts();
      heat_before.copy_from(heat);
      fields.push_back(&heat);
    }
    const CellOverlap<dim> overlap(remapped, fields, model.communicator);
    remap_points(overlap, partition, points);
    if (overlap.has_motion)
      set_masses(overlap, points.mass);
    // Surfaces that move change densities, and so masses beyond what the integrals say.
    NodalVector mass_after, inertia_after;
    if (surface)
    {
      mass_after.reinit(partition, 1);
      mass_after.copy_from(own_mass(partition));
      inertia_after.reinit(partition, 1);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        *inertia_after.node(i) = *inertia.node(i) + *mass_after.node(i) - *mass.node(i);
    }
    project_nodal_field(overlap, 0, inertia, state.unsmoothed_velocity,
                        surface ? &inertia_after : nullptr);
    if (model.heat)
      project_nodal_field(overlap, 1, mass, heat, surface ? &mass_after : nullptr);
    set_points(remapped, points, state.unsmoothed_velocity, clock.previous_step);
    moved.clear();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (!std::equal(places.node(i), places.node(i) + dim, state.position.node(i)))
        moved.push_back(i);
    if (state.unsmoothed_position.partition() != nullptr)
    {
      for (const unsigned int node : moved)
        std::copy_n(places.node(node), dim, state.unsmoothed_position.node(node));
      state.unsmoothed_position.update_ghosts();
    }
    state.position.copy_from(places);
    reference.reinit(partition, node_stride, places.under_reflection());
    reference.copy_from(places);
    model.renew_partition(); // owned nodes keep their local numbers
    if (model.heat)
      set_heat(model, mass, heat_before, heat);
  }

  template <int dim>
  void PartRefill<dim>::set_heat(Model<dim> &model, const NodalVector &mass_before,
                                 const NodalVector &before, NodalVector &after)
  {
    for (std::size_t c = 0; c < lattice.size(); ++c)
      for (unsigned int k = 0; k < local_nodes[c].size(); ++k)
        local_nodes[c][k] = model.state.partition()->local_index(lattice[c].nodes[k]);
    const NodalVector mass = own_mass(model.state.partition());
    ThermalState &thermal = model.heat->state;
    const ThermalProperties &properties = *model.parts[part].heat;
    const auto change = [&](const unsigned int i, const unsigned int slot, double &enthalpy,
                            double &unsmoothed, double &field)
    {
      enthalpy += *mass.node(i) * after.node(i)[slot] - *mass_before.node(i) * before.node(i)[slot];
      field -= unsmoothed;
      unsmoothed = model.heat->nodal_enthalpy.temperature(i, enthalpy);
      field += unsmoothed;
    };
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      if (*mass.node(i) > 0.)
      {
        change(i, 0, *thermal.enthalpy.node(i), *thermal.unsmoothed_temperature.node(i),
               *thermal.temperature.node(i));
        change(i, 1, *thermal.next_enthalpy.node(i), *thermal.next_unsmoothed_temperature.node(i),
               *thermal.next_temperature.node(i));
        *thermal.present_temperature.node(i) = properties.temperature(after.node(i)[2]);
      }
    for (NodalVector *const vector : {&thermal.unsmoothed_temperature, &thermal.temperature,
                                      &thermal.next_unsmoothed_temperature,
                                      &thermal.next_temperature, &thermal.present_temperature})
      vector->update_ghosts();
    model.heat->limit_is_outdated = true;
    cells.point_state().settle_temperature(thermal.present_temperature);
  }

  template <int dim>
  bool PartRefill<dim>::serialize(const Model<dim> &model, StateArchive &archive)
  {
    const auto group = archive.group("refills of " + model.parts[part].name);
    archive("count", count);
    if (count == 0)
      return false;
    if (archive.is_reading())
      reference.reinit(model.state.partition(), node_stride,
                       model.state.position.under_reflection());
    archive.nodal("reference position", dim, reference);
    archive.set_rows(persistent_ids_of_cells(*model.nodes, *model.part_cells, part));
    archive.rows("mass of points", SubCells<dim>::n_sub_cells, point_mass);
    if (archive.is_reading())
      cells.renew_reference(reference);
    return true;
  }

  template class PartRefill<2>;
  template class PartRefill<3>;
} // namespace tombolo
