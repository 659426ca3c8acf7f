// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/formulations/elements/cell_part.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/elements/converting_cells.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** Which of the cells of a part on this rank are none of it any more, removed or become
   * particles, and what was dissipated in them. */
  class LostCells
  {
  public:
    /** Whether a cell, by its number, is no cell of the part any more. */
    bool is_lost(const unsigned int cell) const
    {
      return !lost.empty() && lost[cell];
    }

    /** Whether it became particles. */
    bool is_converted(const unsigned int cell) const
    {
      return cell < converted.size() && converted[cell];
    }

    unsigned int n_converted() const;

    /** is_lost() of all cells; empty before the first. */
    const std::vector<bool> &flags() const
    {
      return lost;
    }

    /** Notes of a part of @p n_cells that @p cells are removed. */
    void remove(const std::vector<unsigned int> &cells, unsigned int n_cells);

    /** ... and that they become particles. */
    void convert(const std::vector<unsigned int> &cells, unsigned int n_cells);

    /** Keeps of the energies that went with cells what these dissipate, but no account that
     * particles have alone. */
    void keep_dissipated(const EnergyAccounts &of_cells);

    const EnergyAccounts &dissipated() const
    {
      return dissipated_in_lost;
    }

    /** Writes to a checkpoint, or reads from it. Returns whether cells were read that are lost.
     * Collective. */
    bool serialize(unsigned int n_cells, bool has_heat, StateArchive &archive);

  private:
    std::vector<bool> lost;      // by cell; empty before the first
    std::vector<bool> converted; // those of them that became particles; likewise
    EnergyAccounts dissipated_in_lost;
  };

  /** Marks the places of cells of this @p degree whose corners are too sharp at these positions. */
  template <int dim>
  void mark_by_shape(const ConversionCriterion &criterion, const CellBatches<dim> &cells,
                     unsigned int degree, const NodalVector &position, std::vector<bool> &converts);

  /** ConvertingCells::add_state() of cells with these points. */
  template <int dim>
  void add_state_of_cells(const PointsInCells<dim> &cell_points, const PartPoints &part_points,
                          const std::vector<unsigned int> &converted, StateTransfer &state);

  /** What all parts have whose cells can become particles: when they do, and which are lost.
   * Integration is what their stresses do at the nodes. */
  template <int dim, typename Points, typename Integration>
  class LosingCells : public CellPart<dim, Points>, public ConvertingCells<dim>
  {
  public:
    explicit LosingCells(const Section &section)
        : criterion(section), integration(section, this->part_points, cell_points)
    {
      this->part_points = PartPoints(section);
    }

    bool can_be_divided() const override
    {
      return true;
    }
    void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) override
    {
      integration.take_volumes(position, are_new);
    }
    void add_internal_force(const MechanicalInput &input, NodalVector &force) override
    {
      integration.add_internal_force(input, force);
    }
    std::string failure() const override
    {
      return integration.failure();
    }
    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force) const override
    {
      integration.apply_elastic_stiffness(position, velocity, time_step, force);
    }
    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override
    {
      integration.find_cell_equations(input, take);
    }
    std::optional<std::string> unfit_to_linearize() const override
    {
      return integration.unfit_to_linearize();
    }

    /** Those of the points, and what was dissipated in cells that are lost. */
    EnergyAccounts energies() const override
    {
      EnergyAccounts result = this->part_points.energies();
      result.add(lost_cells.dissipated());
      return result;
    }

    const ConversionCriterion &conversion() const override
    {
      return criterion;
    }
    std::vector<unsigned int> find_converting_cells(const NodalVector &position) const override
    {
      const CellBatches<dim> &cells = cell_points.cells();
      std::vector<bool> converts;
      for (unsigned int place = 0; place < cells.n_present_cells(); ++place)
        converts.push_back(
            criterion.largest_means.are_reached(this->points(), place, this->n_points_per_cell()));
      mark_by_shape(criterion, cells, this->degree(), position, converts);
      std::vector<double> time_steps;
      if (criterion.smallest_time_step)
        this->courant_limits(position, time_steps);
      std::vector<unsigned int> result;
      for (unsigned int place = 0; place < converts.size(); ++place)
        if (const unsigned int cell = cells.cell_at(place);
            converts[place] ||
            (criterion.smallest_time_step && !(time_steps[cell] >= *criterion.smallest_time_step)))
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
    using CellPart<dim, Points>::cell_points;
    ConversionCriterion criterion; ///< of conversion
    LostCells lost_cells;
    Integration integration;
  };
} // namespace tombolo
