// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_conduction.h>
#include <tombolo/formulations/elements/cell_points.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** What all parts have whose points are in their cells; Points are PointsInCells. */
  template <int dim, typename Points>
  class CellPart : public Formulation<dim>
  {
  public:
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
    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override
    {
      cell_points.cells().add_extra_mass(inertia, mass);
    }
    StepLimit diffusion_limit(const NodalVector &position) const override
    {
      return diffusion_limit_of_cells(
          cell_points.cells(),
          part_points.heat()->largest_diffusivity() / part_points.material().density(), position);
    }
    void add_plastic_heat(NodalVector &heat) override
    {
      cell_points.add_plastic_heat(part_points, heat);
    }
    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &positions) const override
    {
      cell_points.find_positions(position, positions);
    }
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return cell_points.initial_positions();
    }
    unsigned int n_cells() const override
    {
      return cell_points.cells().n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return cell_points.n_points_per_cell();
    }
    unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const override
    {
      return cell_points.point_of_place(cell_points.cells().place(cell), q);
    }

  protected:
    using Formulation<dim>::part_points;
    Points cell_points;
  };
} // namespace tombolo
