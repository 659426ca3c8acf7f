// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/formulations/elements/cell_part.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/mesh/cell_quality.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Cells of a part on this rank that were removed or became particles, and their dissipation. */
  class LostCells
  {
  public:
    /** Whether a cell, by its number, is no cell of the part any more. */
    bool is_lost(const unsigned int cell) const
    {
      return !lost.empty() && lost[cell];
    }

    bool is_converted(const unsigned int cell) const
    {
      return cell < converted.size() && converted[cell];
    }

    unsigned int n_converted() const
    {
      return static_cast<unsigned int>(std::count(converted.begin(), converted.end(), true));
    }

    /** is_lost() of all cells; empty before the first. */
    const std::vector<bool> &flags() const
    {
      return lost;
    }

    /** Notes of a part of @p n_cells that @p cells are removed. */
    void remove(const std::vector<unsigned int> &cells, const unsigned int n_cells)
    {
      lost.resize(n_cells, false);
      for (const unsigned int cell : cells)
        lost[cell] = true;
    }

    /** ... and that they become particles. */
    void convert(const std::vector<unsigned int> &cells, const unsigned int n_cells)
    {
      lost.resize(n_cells, false);
      converted.resize(n_cells, false);
      for (const unsigned int cell : cells)
        lost[cell] = converted[cell] = true;
    }

    /** Keeps what was dissipated in such cells, but no account that particles have alone. */
    void keep_dissipated(const EnergyAccounts &cell_energies)
    {
      for (const EnergyAccounts::Account &account : cell_energies.accounts())
        if (std::any_of(kept.begin(), kept.end(),
                        [&](const auto &kept_account)
                        { return kept_account.first == account.name; }))
          dissipated_in_lost.add(account.name, account.kind, account.value);
    }

    const EnergyAccounts &dissipated() const
    {
      return dissipated_in_lost;
    }

    /** Writes or reads a checkpoint. Returns whether lost cells were read. Collective. */
    bool serialize(const unsigned int n_cells, const bool has_heat, StateArchive &archive)
    {
      constexpr double present = 0., eroded = 1., became_particles = 2.;
      std::vector<double> flags(n_cells, present);
      for (unsigned int cell = 0; cell < n_cells; ++cell)
        if (is_lost(cell))
          flags[cell] = is_converted(cell) ? became_particles : eroded;
      archive.rows("is removed", 1, flags);
      std::array<double, kept.size()> values;
      for (std::size_t k = 0; k < kept.size(); ++k)
        values[k] = dissipated_in_lost[std::string(kept[k].first)];
      archive.sums("dissipated in removed cells", {&values[0], &values[1], &values[2]});
      if (!archive.is_reading())
        return false;
      dissipated_in_lost = EnergyAccounts();
      for (std::size_t k = 0; k < kept.size(); ++k)
        if (has_heat || kept[k].second != EnergyKind::external)
          dissipated_in_lost.add(std::string(kept[k].first), kept[k].second, values[k]);
      lost.clear();
      converted.clear();
      if (std::all_of(flags.begin(), flags.end(),
                      [](const double flag) { return flag == present; }))
        return false;
      for (const double flag : flags)
      {
        lost.push_back(flag != present);
        converted.push_back(flag == became_particles);
      }
      return true;
    }

  private:
    /** The dissipation of lost cells; particles that cells become have further accounts. */
    static constexpr std::array<std::pair<std::string_view, EnergyKind>, 3> kept = {
        {{"plastic dissipation", EnergyKind::dissipated},
         {"viscous dissipation", EnergyKind::artificial},
         {"thermal work", EnergyKind::external}}};

    std::vector<bool> lost;      // by cell; empty before the first
    std::vector<bool> converted; // those of them that became particles; likewise
    EnergyAccounts dissipated_in_lost;
  };

  /** Whether a corner of the cell of this @p degree at a slot is too sharp. */
  template <int dim>
  bool is_too_sharp(const ConversionCriterion &criterion, const CellBatches<dim> &cells,
                    const unsigned int degree, const NodalVector &position, const unsigned int slot)
  {
    if (!criterion.smallest_jacobian)
      return false;
    CellVertices<dim> vertices;
    const unsigned int *const nodes = cells.nodes(slot / n_lanes);
    for (unsigned int corner = 0; corner < vertices.size(); ++corner)
    {
      const unsigned int k = node_of_corner<dim>(degree, corner);
      vertices[corner] = point_of<dim>(position.node(nodes[k * n_lanes + slot % n_lanes]));
    }
    return !(smallest_corner<dim>(vertices) >= *criterion.smallest_jacobian);
  }

  /** ConvertingCells::add_state() of cells with these points. */
  template <int dim>
  void add_state_of_cells(const PointsInCells<dim> &cell_points, const PartPoints &part_points,
                          const std::vector<unsigned int> &converted, StateTransfer &state)
  {
    const CellBatches<dim> &cells = cell_points.cells();
    const MaterialPoints &points = part_points.points();
    const PlasticHeating &heating = part_points.heating();
    const std::vector<std::vector<double>> &shape_values = cell_points.shape_values_at_points();
    const unsigned int n_points = cell_points.n_points_per_cell();
    const double inverse_density = 1. / part_points.material().density();
    const double *const volumes = points.component(MaterialPoints::volume, 0);
    const double *const ratios = points.component(MaterialPoints::volume_ratio, 0);
    std::vector<double> weights(n_points);
    for (const unsigned int cell : converted)
    {
      const unsigned int slot = cells.slot_of(cell);
      const unsigned int *const nodes = cells.nodes(slot / n_lanes) + slot % n_lanes;
      for (unsigned int k = 0; k < cells.n_nodes_per_cell(); ++k)
      {
        const unsigned int node = nodes[k * n_lanes];
        const double volume = inverse_density * cells.mass_of_node(cell, k);
        double sum = 0, pending = 0;
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int point = point_in_lanes(slot, n_points, q);
          weights[q] = shape_values[q][k] * volumes[point] / ratios[point];
          sum += weights[q];
          if (heating.has_plastic_heat())
            pending += shape_values[q][k] * heating.pending(points, point);
        }
        *state.volume.node(node) += volume;
        *state.pending_heat.node(node) += pending;
        for (StateTransfer::Component &component : state.components)
        {
          const double *const values = points.component(component.source_field, component.number);
          double mean = 0;
          for (unsigned int q = 0; q < n_points; ++q)
            mean += weights[q] * values[point_in_lanes(slot, n_points, q)];
          *component.sum.node(node) += volume * mean / sum;
        }
      }
    }
  }

  /** The common base of parts whose cells can become particles. A derived class sets part_points.
   */
  template <int dim, typename Points>
  class LosingCells : public CellPart<dim, Points>, public ConvertingCells<dim>
  {
  public:
    explicit LosingCells(const Section &section) : criterion(section) {}

    bool can_be_divided() const override
    {
      return true;
    }

    /** Those of the points, and what was dissipated in cells that are lost. */
    EnergyAccounts energies() const override
    {
      EnergyAccounts result = this->part_points.energies();
      result.add(lost_cells.dissipated());
      return result;
    }

    /** Of the last forces, or of the start. */
    std::string failure() const override
    {
      return failure_message;
    }

    const ConversionCriterion &conversion() const override
    {
      return criterion;
    }
    std::vector<unsigned int> find_converting_cells(const NodalVector &position) const override
    {
      const CellBatches<dim> &cells = cell_points.cells();
      std::vector<double> time_steps;
      if (criterion.smallest_time_step)
        this->courant_limits(position, time_steps);
      std::vector<unsigned int> result;
      for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
        if (const unsigned int slot = cells.slot_of(cell);
            !lost_cells.is_lost(cell) &&
            (criterion.largest_means.are_reached(this->points(), slot, this->n_points_per_cell()) ||
             is_too_sharp(criterion, cells, this->degree(), position, slot) ||
             (criterion.smallest_time_step &&
              !(time_steps[cell] >= *criterion.smallest_time_step))))
          result.push_back(cell);
      return result;
    }
    void add_state(const std::vector<unsigned int> &converted, StateTransfer &state) const override
    {
      add_state_of_cells(cell_points, this->part_points, converted, state);
    }
    void keep_dissipated(const EnergyAccounts &lost) override
    {
      lost_cells.keep_dissipated(lost);
    }
    unsigned int n_converted_cells() const override
    {
      return lost_cells.n_converted();
    }
    std::vector<dealii::types::global_dof_index>
    nodes_of_cell(const unsigned int cell) const override
    {
      return cell_points.cells().nodes_of_cell(cell);
    }

  protected:
    /** courant_limits() with the length of eq. (41) of the cells of each batch, length_of(batch).
     */
    template <typename LengthOf>
    void find_courant_limits(const LengthOf &length_of, std::vector<double> &time_steps) const
    {
      time_steps.assign(this->n_cells(), StepLimit().time_step);
      const CellBatches<dim> &cells = cell_points.cells();
      const PointStiffness stiffness(this->part_points);
      const double wave_speed = this->material().longitudinal_wave_speed();
      const unsigned int n_points = this->n_points_per_cell();
      for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
      {
        const Lanes length = length_of(batch);
        const Lanes time =
            length / (wave_speed * square_root(stiffness.squared_speed(
                                       std::size_t(batch) * n_points * n_lanes, n_points)));
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
          time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
      }
    }

    using CellPart<dim, Points>::cell_points;
    ConversionCriterion criterion; ///< of conversion
    LostCells lost_cells;
    std::string failure_message;
  };
} // namespace tombolo
