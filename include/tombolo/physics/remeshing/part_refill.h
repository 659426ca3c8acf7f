// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_cells.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/remeshing/nodal_content.h>
#include <tombolo/physics/remeshing/refill_positions.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/remesh/point_remap.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <vector>

namespace tombolo
{
  /** The refills of one part of smoothed cells. */
  template <int dim>
  class PartRefill
  {
  public:
    PartRefill(const Model<dim> &model, const unsigned int part, SmoothedCells<dim> &cells,
               const double end_time)
        : part(part), settings(cells.refill()), cells(cells),
          positions(model, part, cells, end_time),
          rule(cells.point_state().gradients().integration_rule()),
          by_values(settings.value_remap())
    {
      if (settings.is_conservative())
        return;
      const Bodies<dim> mesh_bodies(*model.nodes);
      for (const SmoothedCell<dim> &cell : positions.lattice())
        bodies.push_back(static_cast<double>(mesh_bodies.body_of(cell.nodes.front())));
    }

    /**
     * Where cells have reached a limit: places inner nodes of these cells and of layers around
     * them as in the initial lattice, makes the present configuration the reference, and remaps
     * velocities, heat and points conservatively or by a ValueRemap. Nodes of the boundary of the
     * part slide on it (SurfaceSlide) or stay, and those with prescribed components stay. Where
     * cells would turn over, the nodes move a part of their way. With void cells, cells are filled
     * and emptied as well. Returns whether there was a refill; masses of nodes and the partition
     * are renewed then. Collective.
     */
    bool refill(Model<dim> &model, const Clock &clock)
    {
      std::vector<unsigned int> distorted = cells.distorted_cells(model.state.position);
      positions.motion.add_moved_cells(positions.lattice(), clock.time, model.communicator,
                                       distorted);
      positions.set_partition(*model.state.partition());
      if (settings.fills_cells)
        positions.filled()->add_cells_at_void(model,
                                              refilled_position.partition() != nullptr
                                                  ? refilled_position
                                                  : model.state.initial_position,
                                              distorted);
      if (dealii::Utilities::MPI::max(distorted.empty() ? 0 : 1, model.communicator) == 0)
        return false;
      const NodalVector after = positions.find(model, clock, distorted, material_volumes());
      Cells remapped = remap_cells(model, after);
      const bool is_first = point_mass.empty();
      PointValues points = get_points(remapped);
      if (!renew_reference(after))
      {
        if (is_first)
          point_mass.clear();
        return false; // the part stays as it is
      }
      positions.motion.time_of_last = clock.time;
      model.begin_change();
      remap(model, after, clock, remapped, points);
      if (settings.fills_cells)
        positions.filled()->update_void_cells(model);
      ++count;
      return true;
    }

    /** Scalar, positive at the owned nodes of the cells of the last refill: they get the lost
     * energy. */
    const NodalVector &touched_nodes() const
    {
      return positions.nodes_of_patch();
    }

    /** Owned nodes that the last refill moved, local numbers. */
    const std::vector<unsigned int> &moved_nodes() const
    {
      return moved;
    }

    /** See FilledPositions; only where cells are filled. Collective. */
    std::optional<dealii::Point<dim>> reached_end(const MPI_Comm communicator) const
    {
      return positions.filled()->reached_end(communicator);
    }

    unsigned long n_refills() const
    {
      return count;
    }

    /** Writes or reads the reference of the part, before its points are read. Returns whether it
     * differs from the initial one. Collective. */
    bool serialize(const Model<dim> &model, StateArchive &archive)
    {
      const auto group = archive.group("refills of " + model.parts[part].name);
      archive("count", count);
      if (count == 0)
        return false;
      if (archive.is_reading())
        reference.reinit(model.state.partition(), model.state.position.quantity());
      archive("time of the last", positions.motion.time_of_last);
      archive.nodal("reference position", dim, reference);
      archive.set_rows(model.persistent_ids_of_points(part));
      archive.rows("mass of points", cells.n_points_per_cell(), point_mass);
      if (settings.fills_cells)
      {
        if (archive.is_reading())
          refilled_position.reinit_like(reference);
        archive.nodal("settled position", dim, refilled_position);
        const std::vector<bool> &is_void = cells.void_cells().is_void_by_cell();
        std::vector<double> flags(is_void.begin(), is_void.end());
        archive.rows("is void", 1, flags);
        if (archive.is_reading())
        {
          cells.set_void_cells(std::vector<bool>(flags.begin(), flags.end()));
          cells.point_state().clear(); // other lanes are unused now
        }
      }
      if (!archive.is_reading())
        return true;
      cells.renew_reference(reference);
      if (settings.fills_cells)
        positions.filled()->update_void_cells(model);
      return true;
    }

    const unsigned int part;
    const RefillSettings<dim> &settings;

  private:
    using Corners = typename SubCells<dim>::Corners;

    using Cells = std::vector<RemapCell<dim>>;

    Cells remap_cells(const Model<dim> &model, const NodalVector &after) const
    {
      const NodalVector &before = model.state.position;
      NodalVector near_surface;
      if (settings.fills_cells)
        near_surface = positions.filled()->nodes_near_surface(model);
      Cells result;
      for (const auto &nodes : positions.nodes())
      {
        RemapCell<dim> cell;
        cell.nodes = nodes;
        cell.before = corners_at<dim>(nodes, before);
        cell.after = corners_at<dim>(nodes, after);
        for (unsigned int k = 0; k < nodes.size(); ++k)
          cell.is_cut = cell.is_cut ||
                        (settings.fills_cells ? *near_surface.node(nodes[k]) > 0.
                                              : *positions.sliding_nodes().node(nodes[k]) > 0. &&
                                                    cell.before[k] != cell.after[k]);
        const auto number = static_cast<unsigned int>(result.size());
        cell.is_void_before = cells.is_removed(number);
        cell.is_void_after =
            settings.fills_cells ? positions.filled()->next_void()[number] : cell.is_void_before;
        if (!bodies.empty())
          cell.body = bodies[result.size()];
        result.push_back(cell);
      }
      return result;
    }

    /** Notes the positions to which a refill has moved nodes. */
    void note_refilled_positions(const Model<dim> &model, const NodalVector &after)
    {
      if (refilled_position.partition() == nullptr)
        refilled_position = model.state.initial_position.copy();
      for (unsigned int i = 0; i < after.partition()->n_owned(); ++i)
        if (*positions.nodes_of_patch().node(i) > 0.)
          std::copy_n(after.node(i), node_stride, refilled_position.node(i));
    }

    /** The volume of the material of each cell, m J/ρ₀ [L^dim]; only where cells are filled. */
    std::vector<double> material_volumes()
    {
      std::vector<double> result;
      const SmoothedPointState<dim> state = cells.point_state();
      const double *const ratio = cells.points().component(MaterialPoints::volume_ratio, 0);
      const unsigned int n_points = cells.n_points_per_cell();
      for (unsigned int c = 0; c < cells.n_cells() && settings.fills_cells; ++c)
      {
        result.push_back(0.);
        for (unsigned int q = 0; q < n_points && !cells.is_removed(c); ++q)
        {
          const unsigned int point = cells.point_of_cell(c, q);
          const double mass = point_mass.empty() ? state.mass(point) : point_mass[c * n_points + q];
          result.back() += mass / cells.material().density() * ratio[point];
        }
      }
      return result;
    }

    /** Makes these positions the reference, with the void cells that belong to them. Returns
     * whether that is possible; nothing has changed otherwise. Collective. */
    bool renew_reference(const NodalVector &after)
    {
      const std::vector<bool> void_before = cells.void_cells().is_void_by_cell();
      try
      {
        if (settings.fills_cells)
          cells.set_void_cells(positions.filled()->next_void());
        cells.renew_reference(after);
      }
      catch (const InputError &) // on all ranks
      {
        if (settings.fills_cells)
          cells.set_void_cells(void_before);
        return false;
      }
      return true;
    }

    PointValues get_points(Cells &remapped)
    {
      const SmoothedPointState<dim> state = cells.point_state();
      const unsigned int n_points = cells.n_points_per_cell();
      PointValues result;
      result.n_components = state.n_components();
      result.stress = 0;
      if (point_mass.empty())
        for (unsigned int c = 0; c < remapped.size(); ++c)
          for (unsigned int q = 0; q < n_points; ++q)
            point_mass.push_back(
                remapped[c].is_void_before ? 0. : state.mass(cells.point_of_cell(c, q)));
      result.mass = point_mass;
      result.values.resize(remapped.size() * n_points * result.n_components);
      double *values = result.values.data();
      for (unsigned int c = 0; c < remapped.size(); ++c)
      {
        if (remapped[c].is_void_before)
        {
          std::fill_n(result.mass.begin() + std::ptrdiff_t(c * n_points), n_points, 0.);
          values += std::size_t(n_points) * result.n_components;
          continue;
        }
        const double *const mass = point_mass.data() + std::size_t(c) * n_points;
        for (unsigned int q = 0; q < n_points; ++q, values += result.n_components)
          state.get(cells.point_of_cell(c, q), mass[q], values);
        if (rule == SmoothedIntegrationRule::smoothed)
          std::copy_n(mass, n_points, remapped[c].mass.begin());
        else
          remapped[c].mass =
              shared_by_sub_cells(std::accumulate(mass, mass + n_points, 0.), remapped[c].before);
      }
      return result;
    }

    void set_points(const Cells &remapped, const PointValues &points,
                    const std::vector<double> &volumes)
    {
      SmoothedPointState<dim> state = cells.point_state();
      const unsigned int n_points = cells.n_points_per_cell();
      const double *values = points.values.data();
      if (settings.fills_cells)
        state.clear();
      for (unsigned int c = 0; c < remapped.size(); ++c)
        for (unsigned int q = 0; q < n_points; ++q, values += points.n_components)
        {
          const std::size_t i = std::size_t(c) * n_points + q;
          if (!remapped[c].is_void_after)
            state.set(cells.point_of_cell(c, q), points.mass[i], volumes[i], values);
        }
      point_mass = points.mass;
      state.fill_unused_lanes();
    }

    /** Sets the lumped masses of the cells of after. */
    void set_masses(const CellOverlap<dim> &overlap)
    {
      if (!overlap.has_motion)
        return;
      constexpr unsigned int n_corners = SubCells<dim>::n_corners;
      std::vector<double> masses = cells.masses_of_cells();
      for (std::size_t c = 0; c < overlap.cells.size(); ++c)
        if (overlap.cells[c].is_void_after)
          std::fill_n(masses.begin() + std::ptrdiff_t(c * n_corners), n_corners, 0.);
        else if (overlap.cells[c].has_moved())
          std::copy_n(overlap.integrals[c].mass.begin(), n_corners,
                      masses.begin() + std::ptrdiff_t(c * n_corners));
      cells.set_masses(masses);
    }

    /** The masses of the part at nodes, scalar, owned. Collective. */
    NodalVector own_mass(const std::shared_ptr<const NodePartition> &partition) const
    {
      return sums_at_owners(partition, Quantity::scalar,
                            [&](NodalVector &sums)
                            {
                              const std::vector<double> masses = cells.masses_of_cells();
                              const auto &nodes = positions.nodes();
                              for (std::size_t c = 0; c < nodes.size(); ++c)
                                for (unsigned int k = 0; k < nodes[c].size(); ++k)
                                  *sums.node(nodes[c][k]) += masses[c * nodes[c].size() + k];
                              cells.add_further_masses(sums);
                            });
    }

    void remap(Model<dim> &model, const NodalVector &after, const Clock &clock, Cells &remapped,
               PointValues &points)
    {
      NodalState &state = model.state;
      const auto partition = state.partition();
      NodalContent<dim> nodal(model, part, own_mass(partition));
      if (settings.is_conservative())
        remap_conservatively(model, remapped, nodal, points);
      else
        remap_by_values(model, after, remapped, nodal, points);
      const std::vector<double> volumes =
          former_volumes(remapped, after, state.unsmoothed_velocity, clock.previous_step);
      if (!settings.is_conservative())
        set_masses_from_volumes(remapped, volumes, points, model.communicator);
      set_points(remapped, points, volumes);
      moved.clear();
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (!std::equal(after.node(i), after.node(i) + dim, state.position.node(i)))
          moved.push_back(i);
      if (state.unsmoothed_position.partition() != nullptr)
        state.unsmoothed_position.fill(moved, [&](const std::size_t k, double *const coordinates)
                                       { std::copy_n(after.node(moved[k]), dim, coordinates); });
      if (settings.fills_cells)
        note_refilled_positions(model, after);
      state.position.copy_from(after);
      model.bridge->positions_have_changed();
      reference = after.copy();
      model.renew_partition(); // owned nodes keep their local numbers
      moved.erase(std::remove_if(moved.begin(), moved.end(),
                                 [&](const unsigned int node)
                                 { return *state.mass.node(node) == 0.; }),
                  moved.end());
      if (!model.heat)
        return;
      positions.set_partition(*state.partition());
      nodal.set_enthalpies(model, own_mass(state.partition()));
      cells.point_state().set_point_temperature(model.heat->state.present_temperature);
    }

    /** Integrals over the overlap of cells. Collective. */
    void remap_conservatively(Model<dim> &model, Cells &remapped, NodalContent<dim> &nodal,
                              PointValues &points)
    {
      NodalState &state = model.state;
      const auto partition = state.partition();
      const double relative_inertia = model.parts[part].material->relative_inertia();
      const NodalVector inertia =
          scalar_field(partition, [&](const unsigned int i)
                       { return *model.bridge->mass().node(i) / relative_inertia; });
      std::vector<const NodalVector *> fields(1, &state.unsmoothed_velocity);
      state.unsmoothed_velocity.update_ghosts(); // smoothing does not update them
      if (model.heat)
        fields.push_back(&nodal.enthalpy);
      const CellOverlap<dim> overlap(remapped, fields, model.communicator);
      if (rule == SmoothedIntegrationRule::smoothed)
        remap_points(overlap, partition, points);
      else if (overlap.has_motion)
      {
        PointValues sub_cell_values = values_of_sub_cells(remapped, partition, points);
        remap_points(overlap, partition, sub_cell_values);
        set_means_of_cells(remapped, sub_cell_values, points);
      }
      set_masses(overlap);
      const NodalVector mass_after = own_mass(partition);
      const NodalVector inertia_after =
          scalar_field(partition, [&](const unsigned int i)
                       { return *inertia.node(i) + *mass_after.node(i) - *nodal.mass.node(i); });
      project_nodal_field(overlap, 0, inertia, inertia_after, state.unsmoothed_velocity);
      if (!model.heat)
        return;
      project_nodal_field(overlap, 1, nodal.mass, mass_after, nodal.enthalpy);
      limit_nodal_field(overlap, nodal.initial, mass_after, nodal.enthalpy);
    }

    /** Values at new positions. Collective. */
    void remap_by_values(Model<dim> &model, const NodalVector &after, const Cells &remapped,
                         NodalContent<dim> &nodal, PointValues &points)
    {
      NodalState &state = model.state;
      std::vector<NodalVector *> fields(1, &state.unsmoothed_velocity);
      NodalVector temperatures;
      if (model.heat)
      {
        temperatures = nodal.temperatures(model);
        fields.push_back(&temperatures);
      }
      by_values->remap_nodes(remapped, state.position, after, fields);
      if (model.heat)
        nodal.enthalpy = nodal.enthalpies(model, temperatures);
      by_values->remap_points(remapped, state.partition(),
                              cells.point_state().gradients().corner_shares(), points);
    }

    /** Sets the masses of points and nodes of moved cells to ρ₀/J times these volumes of points,
     * times one factor that keeps the sum of each. Collective. */
    void set_masses_from_volumes(const Cells &remapped, const std::vector<double> &volumes,
                                 PointValues &points, const MPI_Comm communicator)
    {
      const unsigned int n_points = cells.n_points_per_cell();
      constexpr unsigned int n_corners = SubCells<dim>::n_corners;
      constexpr unsigned int ratio = SmoothedPointState<dim>::volume_ratio;
      std::vector<double> masses = cells.masses_of_cells();
      std::array<double, 4> sums{}; // of points and corners, before and after
      for (std::size_t c = 0; c < remapped.size(); ++c)
      {
        if (!remapped[c].has_moved())
          continue;
        double cell_mass = 0;
        for (std::size_t i = c * n_points; i < (c + 1) * n_points; ++i)
        {
          sums[0] += points.mass[i];
          points.mass[i] = cells.material().density() * volumes[i] /
                           points.values[i * points.n_components + ratio];
          cell_mass += points.mass[i];
        }
        sums[1] += cell_mass;
        std::array<double, SubCells<dim>::n_sub_cells> sub_cell_masses;
        if (rule == SmoothedIntegrationRule::smoothed)
          std::copy_n(points.mass.begin() + std::ptrdiff_t(c * n_points), n_points,
                      sub_cell_masses.begin());
        else
          sub_cell_masses = shared_by_sub_cells(cell_mass, remapped[c].after);
        const auto corner_masses =
            masses_of_corners<dim>(remapped[c].after, sub_cell_masses.data());
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          double &mass = masses[c * n_corners + k];
          sums[2] += mass;
          mass = corner_masses[k];
          sums[3] += mass;
        }
      }
      sums = ordered_sum(sums, communicator);
      for (std::size_t c = 0; c < remapped.size(); ++c)
      {
        if (!remapped[c].has_moved())
          continue;
        for (std::size_t i = c * n_points; i < (c + 1) * n_points; ++i)
          points.mass[i] *= sums[0] / sums[1];
        for (std::size_t i = c * n_corners; i < (c + 1) * n_corners; ++i)
          masses[i] *= sums[2] / sums[3];
      }
      cells.set_masses(masses);
    }

    /** A mass that is uniform in a cell. */
    static std::array<double, SubCells<dim>::n_sub_cells>
    shared_by_sub_cells(const double mass, const typename SubCells<dim>::Corners &corners)
    {
      auto result = CellSimplices<dim>::volumes(corners);
      double total = 0;
      for (double &volume : result)
      {
        volume = std::max(volume, 0.);
        total += volume;
      }
      for (double &volume : result)
        volume *= mass / total;
      return result;
    }

    /** The volumes of the points of a cell with nodes at @p position_of (local number). */
    template <typename PositionOf>
    std::vector<double> volumes_of_cell(const std::size_t cell, const RemapCell<dim> &remapped,
                                        const NodePartition &partition,
                                        const PositionOf &position_of) const
    {
      typename SubCells<dim>::Corners corners;
      for (unsigned int k = 0; k < corners.size(); ++k)
        corners[k] = position_of(remapped.nodes[k]);
      if (rule != SmoothedIntegrationRule::smoothed)
        return {determinant(PointOfCell<dim>(corners).jacobian)};
      const SmoothedCell<dim> &lattice_cell = positions.lattice()[cell];
      const auto volumes = !lattice_cell.has_further_nodes()
                               ? CellSimplices<dim>::volumes(corners)
                               : volumes_within<dim>(present_facets<dim>(
                                     lattice_cell, [&](const dealii::types::global_dof_index node)
                                     { return position_of(partition.local_index(node)); }));
      return {volumes.begin(), volumes.end()};
    }

    /** The volumes of all points at t_{n-1}, by cell and point; zero of void cells. @p after: the
     * positions of their nodes at t_n, with ghosts as @p velocity. */
    std::vector<double> former_volumes(const Cells &remapped, const NodalVector &after,
                                       const NodalVector &velocity, const double step) const
    {
      std::vector<double> result;
      for (std::size_t c = 0; c < remapped.size(); ++c)
      {
        // The state is that of t_{n-1}, and the step to t_n is still to come.
        const auto volumes_since = [&](const double since)
        {
          const auto position_of = [&](const unsigned int node)
          {
            dealii::Point<dim> position;
            for (unsigned int d = 0; d < dim; ++d)
              position[d] = after.node(node)[d] - since * velocity.node(node)[d];
            return position;
          };
          return volumes_of_cell(c, remapped[c], *after.partition(), position_of);
        };
        const std::vector<double> volumes = volumes_since(0.), former = volumes_since(step);
        const double now = std::accumulate(volumes.begin(), volumes.end(), 0.);
        const double before = std::accumulate(former.begin(), former.end(), 0.);
        for (const double volume : volumes)
          result.push_back(remapped[c].is_void_after ? 0. : volume * before / now);
      }
      return result;
    }

    SmoothedCells<dim> &cells;
    RefillPositions<dim> positions;
    SmoothedIntegrationRule rule;
    std::unique_ptr<ValueRemap<dim>> by_values; ///< null: the remap is conservative
    NodalVector reference;
    NodalVector refilled_position; ///< by the last refill of each node; where cells are filled
    /** Of the points, by cell; empty before the first refill. Beside J, since the volume of a
     * cell and the determinants of its points follow different means of the motion [M]. */
    std::vector<double> point_mass;
    std::vector<unsigned int> moved;
    std::vector<double> bodies; ///< of cells; for a ValueRemap
    unsigned long count = 0;
  };

  extern template class PartRefill<2>;
  extern template class PartRefill<3>;
} // namespace tombolo
