// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/smoothed/refilled_cells.h>
#include <tombolo/formulations/smoothed/smoothed_cell.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>
#include <tombolo/formulations/smoothed/smoothed_integration.h>
#include <tombolo/formulations/smoothed/smoothed_point_state.h>

#include <vector>

namespace tombolo
{
  /**
   * An element-free Galerkin part: cells whose functions are those of a convex approximation, with
   * smoothed gradients (SmoothedGradients). Its nodes are nodes of elements to everybody else:
   * masses are lumped as those of linear elements, velocities are not smoothed, loads and contact
   * act at the nodes, and elements beside it share nodes without a bridge. A plane of symmetry is a
   * boundary: the functions do not see the image of the part. Cells may lie beside cells of half
   * their size (FaceNodes).
   */
  template <int dim>
  class SmoothedCells : public LosingCells<dim, PointsInCells<dim>, SmoothedIntegration<dim>>
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
    StepCost step_cost(const Material &material, double box_ratio) const override;
    void initialize(const PartSetup<dim> &of_part) override;
    dealii::IndexSet required_nodes() const override;
    void set_partition(const NodePartition &partition) override;
    void add_mass(NodalVector &mass) const override;
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override;
    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      rows.add_conduction(cell_points.cells(), part_points.heat()->conductivity(), position,
                          of_conductivity, temperature, heat_rate);
    }
    void add_plastic_heat(NodalVector &heat) override;
    bool is_removed(const unsigned int cell) const override
    {
      return void_cells().is_on() && void_cells().of_cells()[cell];
    }
    bool can_lose_cells() const override
    {
      return void_cells().is_on();
    }
    void list(Records &records) override;

    void find_couplings(const NodeGroupAction &use) const override
    {
      rows.find_couplings(this->n_cells(), use);
    }
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
    const RefillSettings<dim> &refill() const
    {
      return refill_settings;
    }

    /** The cells of this rank that have reached a limit of refill(). */
    std::vector<unsigned int> distorted_cells(const NodalVector &position) const;

    const VoidCells<dim> &void_cells() const
    {
      return voids;
    }

    /** Fills and empties cells: points get other numbers, and renew_reference() must follow. Only
     * where void_cells() are on. Collective. */
    void set_void_cells(const std::vector<bool> &is_void);

    /** The lumped masses of the nodes, by cell and corner; only with refills [M]. */
    const std::vector<double> &masses_of_cells() const
    {
      return cell_points.cells().masses();
    }
    /** Adds what further nodes have of cells beside them, and corners less (see FurtherMasses). */
    void add_further_masses(NodalVector &mass) const
    {
      further_masses.add_mass(mass);
    }
    void set_masses(const std::vector<double> &of_cells)
    {
      cell_points.cells().set_masses(of_cells);
    }

    /** Takes these positions as the reference configuration; required_nodes() stay. Rows must not
     * be used before set_partition(). Throws the InputError of SmoothedGradients::initialize(), and
     * stays as it is. Collective. */
    void renew_reference(const NodalVector &position);

    SmoothedPointState<dim> point_state()
    {
      return {part_points, rows, cell_points};
    }
    ///@}

  private:
    void take_masses_of_void_cells();

    static constexpr unsigned int n_corners = dealii::GeometryInfo<dim>::vertices_per_cell;
    using Base = LosingCells<dim, PointsInCells<dim>, SmoothedIntegration<dim>>;
    using Base::cell_points, Base::criterion, Base::integration, Base::lost_cells,
        Base::part_points;

    SmoothedGradients<dim> &rows = integration.rows;
    FurtherMasses<dim> further_masses;
    const RefillSettings<dim> refill_settings;
    PartSetup<dim> setup; // with void cells
    VoidCells<dim> voids;
    NodalVector reference; // of the rows; empty: the initial positions, or nothing needs it
  };
} // namespace tombolo
