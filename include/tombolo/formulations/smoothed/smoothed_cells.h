// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/smoothed/refilled_cells.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>
#include <tombolo/formulations/smoothed/smoothed_integration.h>
#include <tombolo/formulations/smoothed/smoothed_point_state.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * An element-free Galerkin part: cells whose functions are those of a convex approximation, with
   * smoothed gradients (SmoothedGradients). Its nodes are nodes of elements to everybody else:
   * masses are lumped as those of linear elements, velocities are not smoothed, loads and contact
   * act at the nodes, and elements beside it share nodes without a bridge. A plane of symmetry is a
   * boundary: the functions do not see the image of the part. Cells may lie beside cells of half
   * their size (RefinedFace).
   */
  template <int dim>
  class SmoothedCells : public Formulation<dim>, public LosingCells<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    explicit SmoothedCells(const Section &section);

    unsigned int degree() const override
    {
      return 1;
    }
    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::free;
    }
    bool can_be_divided() const override
    {
      return true;
    }
    void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) override
    {
      integration.take_volumes(position, are_new);
    }
    double cost_per_cell(const Material &material, double box_ratio) const override;
    void initialize(const PartSetup<dim> &setup) override;
    dealii::IndexSet required_nodes() const override;
    void set_partition(const NodePartition &partition) override;
    void add_mass(NodalVector &mass) const override;
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
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override;
    EnergyAccounts energies() const override;
    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      rows.add_conduction(cells, heat->conductivity(), position, of_conductivity, temperature,
                          heat_rate);
    }
    StepLimit diffusion_limit(const NodalVector &position) const override;
    void add_plastic_heat(NodalVector &heat) override;
    double pending_plastic_heat() const override
    {
      return integration.pending_plastic_heat();
    }
    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &positions) const override;
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return initial_points;
    }
    const MaterialPoints &points() const override
    {
      return integration.points();
    }
    MaterialPoints &points() override
    {
      return integration.points();
    }
    const Material &material() const override
    {
      return integration.material();
    }
    unsigned int n_cells() const override
    {
      return cells.n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return has_points ? rows.n_points_per_cell() : 0;
    }
    unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const override
    {
      return point_at(cells.place(cell), q);
    }
    bool is_removed(const unsigned int cell) const override
    {
      return void_cells().is_on() && void_cells().of_cells()[cell];
    }
    bool can_lose_cells() const override
    {
      return void_cells().is_on();
    }
    void list(Records &records) override;

    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override
    {
      integration.find_cell_equations(input, take);
    }
    void find_couplings(const NodeGroupAction &use) const override
    {
      rows.find_couplings(n_cells(), use);
    }
    std::optional<std::string> unfit_to_linearize() const override
    {
      return integration.unfit_to_linearize();
    }

    std::vector<unsigned int> find_converting_cells(const NodalVector &position) const override;
    void add_state(const std::vector<unsigned int> &converted, StateTransfer &state) const override;
    void deactivate_cells(const std::vector<unsigned int> &converted) override
    {
      take_converted_cells(converted);
    }
    void take_converted_cells(const std::vector<unsigned int> &converted) override;
    bool masses_move() const override
    {
      return refill().is_on();
    }

    /** @name Refills
     * The reference configuration of the functions becomes a later one, with nodes at other places.
     * Points and masses are given by whoever does it. */
    ///@{
    const RefillSettings &refill() const
    {
      return refilled.settings();
    }

    /** The cells of this rank that have reached a limit of refill(). */
    std::vector<unsigned int> distorted_cells(const NodalVector &position) const;

    const VoidCells<dim> &void_cells() const
    {
      return refilled.void_cells();
    }

    /** Fills and empties cells: points get other numbers, and renew_reference() must follow. Only
     * where void_cells() are on. Collective. */
    void set_void_cells(const std::vector<bool> &is_void);

    /** The nodes of a cell; only with refills or conversion. */
    std::vector<dealii::types::global_dof_index> nodes_of_cell(unsigned int cell) const override;

    /** The lumped masses of the nodes, by cell and corner; only with refills [M]. */
    std::vector<double> masses_of_cells() const;
    /** Adds what hanging nodes have of cells beside them, and corners less (see HangingMasses). */
    void add_hanging_masses(NodalVector &mass) const;
    void set_masses(const std::vector<double> &of_cells);

    /** Takes these positions as the reference configuration; required_nodes() stay. Rows must not
     * be used before set_partition(). Throws the InputError of SmoothedGradients::initialize(), and
     * stays as it is. Collective. */
    void renew_reference(const NodalVector &position);

    SmoothedPointState<dim> point_state();
    ///@}

  private:
    static constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
    using CellNodes = Lanes[n_corners][dim];

    /** Puts void cells behind the others, in all that goes by places. */
    void take_void_cells();
    /** The number of point @p q of the cell at a place. */
    unsigned int point_at(const unsigned int place, const unsigned int q) const
    {
      return point_in_lanes(place, n_points_per_cell(), q);
    }

    /** Calls @p use(batch, positions of the nodes). */
    void for_batches(const NodalVector &position,
                     const std::function<void(unsigned int, const CellNodes &)> &use) const;

    SmoothedGradients<dim> rows;
    SmoothedIntegration<dim> integration;
    CellBatches<dim> cells;
    HangingMasses<dim> hanging_masses;
    std::shared_ptr<const ThermalProperties> heat;
    bool has_points = true;
    std::vector<dealii::Point<dim>> initial_points;
    RefilledCells<dim> refilled;
    NodalVector reference; // of the rows; empty: the initial positions, or nothing needs it
    using LosingCells<dim>::criterion;
    using LosingCells<dim>::lost_cells;
  };
} // namespace tombolo
