// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/part_refill.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/model/persistent_cell_ids.h>
#include <tombolo/remesh/corners_at.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  PartRefill<dim>::PartRefill(const Model<dim> &model, const unsigned int part,
                              SmoothedCells<dim> &cells, const double end_time)
      : part(part), cells(cells), places(model, part, cells.refill(), end_time)
  {}

  template <int dim>
  bool PartRefill<dim>::refill(Model<dim> &model, const Clock &clock)
  {
    std::vector<unsigned int> distorted = cells.distorted_cells(model.state.position);
    places.add_moved_cells(model, clock, distorted);
    if (Utilities::MPI::max(distorted.empty() ? 0 : 1, model.communicator) == 0)
      return false;
    places.set_partition(*model.state.partition());
    const NodalVector after = places.find(model, clock, distorted);
    try
    {
      cells.renew_reference(after);
    }
    catch (const InputError &)
    {
      return false; // all ranks; the part goes on as it is
    }
    places.time_of_last() = clock.time;
    model.begin_change();
    remap(model, after, clock);
    ++count;
    return true;
  }

  template <int dim>
  std::vector<RemapCell<dim>> PartRefill<dim>::remap_cells(const NodalVector &before,
                                                           const NodalVector &after) const
  {
    std::vector<RemapCell<dim>> result;
    for (const auto &nodes : places.nodes())
    {
      RemapCell<dim> cell;
      cell.nodes = nodes;
      cell.before = corners_at<dim>(nodes, before);
      cell.after = corners_at<dim>(nodes, after);
      for (unsigned int k = 0; k < nodes.size(); ++k)
        cell.is_cut = cell.is_cut || (*places.sliding_nodes().node(nodes[k]) > 0. &&
                                      cell.before[k] != cell.after[k]);
      result.push_back(cell);
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
    const auto &nodes = places.nodes();
    for (std::size_t c = 0; c < nodes.size(); ++c)
      for (unsigned int k = 0; k < nodes[c].size(); ++k)
        *result.node(nodes[c][k]) += masses[c * nodes[c].size() + k];
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
        slides() ? std::vector<double>(masses.size(), 0.) : gained_masses(overlap);
    for (std::size_t i = 0; i < masses.size(); ++i)
      masses[i] += gained[i];
    for (std::size_t c = 0; slides() && c < overlap.cells.size(); ++c)
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
  void PartRefill<dim>::remap(Model<dim> &model, const NodalVector &after, const Clock &clock)
  {
    NodalState &state = model.state;
    const auto partition = state.partition();
    std::vector<RemapCell<dim>> remapped = remap_cells(state.position, after);
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
    if (slides())
    {
      mass_after.reinit(partition, 1);
      mass_after.copy_from(own_mass(partition));
      inertia_after.reinit(partition, 1);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        *inertia_after.node(i) = *inertia.node(i) + *mass_after.node(i) - *mass.node(i);
    }
    project_nodal_field(overlap, 0, inertia, state.unsmoothed_velocity,
                        slides() ? &inertia_after : nullptr);
    if (model.heat)
      project_nodal_field(overlap, 1, mass, heat, slides() ? &mass_after : nullptr);
    set_points(remapped, points, state.unsmoothed_velocity, clock.previous_step);
    moved.clear();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (!std::equal(after.node(i), after.node(i) + dim, state.position.node(i)))
        moved.push_back(i);
    if (state.unsmoothed_position.partition() != nullptr)
    {
      for (const unsigned int node : moved)
        std::copy_n(after.node(node), dim, state.unsmoothed_position.node(node));
      state.unsmoothed_position.update_ghosts();
    }
    state.position.copy_from(after);
    reference.reinit(partition, node_stride, after.under_reflection());
    reference.copy_from(after);
    model.renew_partition(); // owned nodes keep their local numbers
    if (model.heat)
      set_heat(model, mass, heat_before, heat);
  }

  template <int dim>
  void PartRefill<dim>::set_heat(Model<dim> &model, const NodalVector &mass_before,
                                 const NodalVector &before, NodalVector &after)
  {
    places.set_partition(*model.state.partition());
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
    archive("time of the last", places.time_of_last());
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
