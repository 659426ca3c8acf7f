// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_conduction.h>
#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/rigid_cells.h>
#include <tombolo/formulations/formulation.h>

#include <deal.II/base/utilities.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** What CellPoints and ConductionElement need to know of a cell without stress. */
  template <int dim, unsigned int p>
  struct RigidCell
  {
    static constexpr unsigned int degree = p;
    static constexpr unsigned int n_nodes =
        static_cast<unsigned int>(dealii::Utilities::pow(p + 1, dim));
    static constexpr unsigned int n_points = 1;
    static constexpr MassLumping lumping =
        p == 1 ? MassLumping::row_sum : MassLumping::gauss_lobatto;
  };

  /**
   * A part of cells that conduct heat and have mass, and no stress: its nodes move as one rigid
   * body (doc/rigid_bodies.md). There are no material points, no internal force, and no limit of
   * the step of mechanics. Mass and capacity are lumped to the nodes as those of other elements of
   * the degree.
   */
  template <int dim, unsigned int p>
  class RigidFormulation : public Formulation<dim>, public RigidCells<dim>
  {
  public:
    unsigned int degree() const override
    {
      return p;
    }

    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }

    double cost_per_cell(const Material &material, double box_ratio) const override;

    void initialize(const PartSetup<dim> &setup) override;

    const MassMoments &mass_moments() const override
    {
      return moments;
    }

    dealii::IndexSet required_nodes() const override
    {
      return cell_points.cells().required_nodes();
    }
    void set_partition(const NodePartition &partition) override
    {
      cell_points.set_partition(partition);
    }
    void add_mass(NodalVector &mass) const override
    {
      cell_points.cells().add_mass(mass);
    }

    void add_internal_force(const MechanicalInput & /*input*/, NodalVector & /*force*/) override {}
    void apply_elastic_stiffness(const NodalVector & /*position*/, const NodalVector & /*velocity*/,
                                 const double /*time_step*/, NodalVector & /*force*/) const override
    {}
    /** No cell has a limit. */
    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;
    void add_extra_mass(const std::vector<double> & /*inertia*/,
                        NodalVector & /*mass*/) const override
    {}
    EnergyAccounts energies() const override
    {
      return {};
    }

    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      add_conduction_of_cells(cell_points, *heat, position, of_conductivity, temperature,
                              heat_rate);
    }
    StepLimit diffusion_limit(const NodalVector &position) const override
    {
      return diffusion_limit_of_cells(
          cell_points.cells(), heat->largest_diffusivity() / part_material->density(), position);
    }

    void point_positions(const NodalVector & /*position*/,
                         std::vector<dealii::Point<dim>> &points) const override
    {
      points.clear();
    }
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return cell_points.initial_positions();
    }
    const MaterialPoints &points() const override
    {
      return cell_points.material_points();
    }
    MaterialPoints &points() override
    {
      return cell_points.material_points();
    }
    const Material &material() const override
    {
      return *part_material;
    }
    unsigned int n_cells() const override
    {
      return cell_points.cells().n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return 0;
    }

  private:
    CellPoints<dim, RigidCell<dim, p>> cell_points;
    std::shared_ptr<const Material> part_material;
    std::shared_ptr<const ThermalProperties> heat;
    MassMoments moments;
  };
} // namespace tombolo
