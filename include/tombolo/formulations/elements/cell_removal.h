// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The members of CellFormulation that have to do with energies, and with cells that turn inside out
// or are removed; included at its end.
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/state/state_archive.h>

namespace tombolo
{
  template <int dim, typename Element>
  EnergyAccounts CellFormulation<dim, Element>::energies() const
  {
    EnergyAccounts result;
    Lanes elastic = 0., stored = 0., dissipated = 0.;
    std::vector<const double *> variables(element_variables.size());
    alignas(64) double density[points_per_batch];
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      const std::size_t first = std::size_t(batch) * points_per_batch;
      const double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = material_points.component(MaterialPoints::stress, c) + first;
      const double *const temperature = plastic_heating.temperature(material_points);
      part_material->elastic_energy_density(points_per_batch, stress,
                                            temperature == nullptr ? nullptr : temperature + first,
                                            density);
      const double *const volume = material_points.component(MaterialPoints::volume, 0) + first;
      for (unsigned int i = 0; i < points_per_batch; i += n_lanes)
        elastic += load_lanes(density + i) * load_lanes(volume + i);

      Lanes batch_stored = 0., batch_dissipated = 0.;
      for (std::size_t c = 0; c < variables.size(); ++c)
        variables[c] = element_variables[c] + first;
      element.add_energies(variables.data(), batch_stored, batch_dissipated);
      const unsigned int n_valid = cells.n_valid(batch);
      const Lanes is_cell([&](const auto lane) { return lane < n_valid ? 1. : 0.; });
      stored += is_cell * batch_stored;
      dissipated += is_cell * batch_dissipated;
    }
    result.add("elastic energy", EnergyKind::stored, reduce(elastic));
    result.add("plastic dissipation", EnergyKind::dissipated,
               integral_over_initial_volume(material_points, "plastic work"));
    result.add("hourglass energy", EnergyKind::stored, reduce(stored));
    result.add("viscous dissipation", EnergyKind::artificial,
               reduce(dissipated) +
                   integral_over_initial_volume(material_points, BulkViscosity::dissipation_name));
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(material_points, "thermal work"));
    result.add(dissipated_in_removed);
    return result;
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::note_failure(const unsigned int batch, const NodeValues &x,
                                                   const Lanes (&volume)[n_points])
  {
    auto is_sound = volume[0] > 0.;
    for (unsigned int q = 1; q < n_points; ++q)
      is_sound = is_sound && volume[q] > 0.;
    if (all_of(is_sound) || !failure_message.empty())
      return;
    for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
      if (!is_sound[lane])
      {
        dealii::Point<dim> centre, initial;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int k = 0; k < n_nodes; ++k)
            centre[d] += x[k][d][lane] / n_nodes;
        for (unsigned int q = 0; q < n_points; ++q)
          initial += initial_points[point_at(batch * n_lanes + lane, q)] / double(n_points);
        double smallest = volume[0][lane];
        for (unsigned int q = 1; q < n_points; ++q)
          if (!(volume[q][lane] >= smallest))
            smallest = volume[q][lane];
        failure_message = describe_unusable_cell(centre, initial, smallest);
        return;
      }
  }

  template <int dim, typename Element>
  bool CellFormulation<dim, Element>::is_volume_positive(const unsigned int place,
                                                         const NodalVector &position) const
  {
    NodeValues x;
    Lanes volume[n_points];
    find_volumes(place / n_lanes, position, x, volume);
    return std::all_of(volume, volume + n_points,
                       [&](const Lanes &of_point) { return of_point[place % n_lanes] > 0.; });
  }

  template <int dim, typename Element>
  unsigned int CellFormulation<dim, Element>::find_failed_cells(const NodalVector &position)
  {
    // A point with more than this part of its initial volume does not lose it in one stable step.
    constexpr double small_volume = 0.5;
    failed_places.clear();
    const double *const strains = erosion.plastic_strain(material_points);
    const double *const ratios = material_points.component(MaterialPoints::volume_ratio, 0);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      const std::size_t first = std::size_t(batch) * points_per_batch;
      Lanes strain = 0., ratio = load_lanes(ratios + first);
      for (unsigned int i = 0; i < points_per_batch; i += n_lanes)
      {
        strain += load_lanes(strains + first + i);
        ratio = min(ratio, load_lanes(ratios + first + i));
      }
      strain /= double(n_points);
      if (all_of(strain < erosion.strain() && ratio > small_volume))
        continue;
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        if (strain[lane] >= erosion.strain() ||
            (!(ratio[lane] > small_volume) &&
             !is_volume_positive(batch * n_lanes + lane, position)))
          failed_places.push_back(batch * n_lanes + lane);
    }
    return static_cast<unsigned int>(failed_places.size());
  }

  /** The power of the internal forces of t_{n-1} on @p velocity, that of a cell which has moved
   * with it to @p position. */
  template <int dim, typename Element>
  double CellFormulation<dim, Element>::internal_power(const unsigned int place,
                                                       const NodalVector &position,
                                                       const NodalVector &velocity,
                                                       const double time_increment) const
  {
    const unsigned int batch = place / n_lanes, lane = place % n_lanes;
    const std::size_t first = std::size_t(batch) * points_per_batch;
    NodeValues x, v;
    gather(batch, position, x);
    gather(batch, velocity, v);
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        x[k][d] -= time_increment * v[k][d];
    typename Element::Work work;
    Lanes volume[n_points];
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);

    // A step of no duration gives the element's own forces; it is made with a copy, since cells of
    // the same batch remain.
    dealii::AlignedVector<double> copy(element_variables.size() * points_per_batch);
    Pointers variables;
    for (std::size_t c = 0; c < element_variables.size(); ++c)
    {
      variables.push_back(copy.data() + c * points_per_batch);
      std::copy_n(element_variables[c] + first, points_per_batch, variables.back());
    }
    Lanes spin[n_points][3];
    for (auto &of_point : spin)
      for (Lanes &component : of_point)
        component = 0.;
    element.advance(work, spin, 0., variables.data());

    Lanes stress[n_points][6];
    integrate_stress(batch, stress);
    NodeValues force;
    element.integrate(work, stress, force);
    double power = 0;
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        power += force[k][d][lane] * v[k][d][lane];
    return power;
  }

  template <int dim, typename Element>
  RemovedCells CellFormulation<dim, Element>::remove_failed_cells(const NodalVector &position,
                                                                  const NodalVector &velocity,
                                                                  const double time_increment)
  {
    RemovedCells result;
    if (failed_places.empty())
      return result;
    const EnergyAccounts before = energies();
    const double pending_before = plastic_heating.pending(material_points);
    double power = 0;
    for (const unsigned int place : failed_places)
      power += internal_power(place, position, velocity, time_increment);

    removed.resize(cells.n_cells(), false);
    for (const unsigned int place : failed_places)
      removed[cells.cell_at(place)] = true;
    result.n_cells = static_cast<unsigned int>(failed_places.size());
    failed_places.clear();
    close_up();

    EnergyAccounts lost = before;
    lost.add(energies(), -1.);
    keep_dissipated(lost);
    result.energy = lost.sum_of(EnergyKind::stored) + 0.5 * time_increment * power;
    result.pending_heat = pending_before - plastic_heating.pending(material_points);
    return result;
  }

  /** Brings the points of all cells to their places after cells were removed. */
  template <int dim, typename Element>
  void CellFormulation<dim, Element>::close_up()
  {
    const unsigned int n_places = cells.n_batches_of_places() * n_lanes;
    std::vector<unsigned int> from(n_places, 0);
    std::vector<unsigned int> old_place(cells.n_cells());
    for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      old_place[cell] = cells.place(cell);
    cells.remove(removed);
    for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      from[cells.place(cell)] = old_place[cell];
    const unsigned int n_present = cells.n_present_cells();
    for (unsigned int place = n_present; place < padded_to_lanes(n_present); ++place)
      from[place] = from[n_present - 1];

    std::vector<double> old(material_points.size());
    for (unsigned int f = 0; f < material_points.fields().size(); ++f)
      for (unsigned int c = 0; c < material_points.fields()[f].n_components; ++c)
      {
        double *const values = material_points.component(f, c);
        std::copy_n(values, old.size(), old.begin());
        for (unsigned int place = 0; place < n_places; ++place)
          for (unsigned int q = 0; q < n_points; ++q)
            values[point_at(place, q)] = old[point_at(from[place], q)];
      }
    const std::vector<dealii::Point<dim>> old_points = initial_points;
    for (unsigned int place = 0; place < n_places; ++place)
      for (unsigned int q = 0; q < n_points; ++q)
      {
        initial_points[point_at(place, q)] = old_points[point_at(from[place], q)];
        if (place < n_present)
          continue;
        material_points.component(MaterialPoints::volume, 0)[point_at(place, q)] = 0.;
        material_points.component(MaterialPoints::volume_ratio, 0)[point_at(place, q)] = 1.;
      }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_nodes_of_removed_cells(
      std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const
  {
    for (unsigned int cell = 0; cell < removed.size(); ++cell)
      if (removed[cell] && !(cell < converted.size() && converted[cell]))
        nodes_of_cells.push_back(cells.nodes_of_cell(cell));
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::serialize(StateArchive &archive)
  {
    if (!erosion.is_on() && !criterion.is_on())
      return;
    constexpr double present = 0., eroded = 1., became_particles = 2.;
    std::vector<double> flags(cells.n_cells(), present);
    for (unsigned int cell = 0; cell < flags.size(); ++cell)
      if (is_removed(cell))
        flags[cell] = cell < converted.size() && converted[cell] ? became_particles : eroded;
    archive.rows("is removed", 1, flags);
    double plastic = dissipated_in_removed["plastic dissipation"],
           viscous = dissipated_in_removed["viscous dissipation"],
           thermal_work = dissipated_in_removed["thermal work"];
    archive.sums("dissipated in removed cells", {&plastic, &viscous, &thermal_work});
    if (!archive.is_reading())
      return;
    dissipated_in_removed = EnergyAccounts();
    dissipated_in_removed.add("plastic dissipation", EnergyKind::dissipated, plastic);
    dissipated_in_removed.add("viscous dissipation", EnergyKind::artificial, viscous);
    if (thermal_properties)
      dissipated_in_removed.add("thermal work", EnergyKind::external, thermal_work);
    removed.clear();
    converted.clear();
    if (std::all_of(flags.begin(), flags.end(), [](const double flag) { return flag == present; }))
      return;
    for (const double flag : flags)
    {
      removed.push_back(flag != present);
      converted.push_back(flag == became_particles);
    }
    close_up();
  }
} // namespace tombolo
