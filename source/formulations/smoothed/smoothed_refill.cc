// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

#include <tombolo/formulations/elements/cell_conversion.h>
#include <tombolo/state/state_archive.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  std::vector<unsigned int> SmoothedCells<dim>::distorted_cells(const NodalVector &position) const
  {
    std::vector<unsigned int> result, points(n_points_per_cell());
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
    {
      if (is_removed(cell))
        continue;
      for (unsigned int q = 0; q < points.size(); ++q)
        points[q] = point_of_cell(cell, q);
      if (refilled.is_distorted(rows.stencils(), points, position))
        result.push_back(cell);
    }
    return result;
  }

  template <int dim>
  void SmoothedCells<dim>::set_void_cells(const std::vector<bool> &is_void)
  {
    refilled.set_void_cells(is_void);
    take_void_cells();
  }

  template <int dim>
  void SmoothedCells<dim>::take_void_cells()
  {
    const unsigned int n_points = n_points_per_cell();
    const std::vector<unsigned int> from =
        remove_cells(void_cells().of_cells(), n_points, cells, integration.points());
    const std::vector<Point<dim>> old = initial_points;
    initial_points.assign(from.size() * n_points, Point<dim>());
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int q = 0; q < n_points; ++q)
        initial_points[point_of_cell(cell, q)] = old[point_at(from[cells.place(cell)], q)];
  }

  template <int dim>
  std::vector<types::global_dof_index>
  SmoothedCells<dim>::nodes_of_cell(const unsigned int cell) const
  {
    return cells.nodes_of_cell(cell);
  }

  template <int dim>
  std::vector<double> SmoothedCells<dim>::masses_of_cells() const
  {
    std::vector<double> result;
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int k = 0; k < n_corners; ++k)
        result.push_back(cells.mass_of_node(cell, k));
    return result;
  }

  template <int dim>
  void SmoothedCells<dim>::add_hanging_masses(NodalVector &mass) const
  {
    hanging_masses.add_mass(mass);
  }

  template <int dim>
  void SmoothedCells<dim>::set_masses(const std::vector<double> &of_cells)
  {
    cells.set_masses(of_cells);
  }

  template <int dim>
  void SmoothedCells<dim>::renew_reference(const NodalVector &position)
  {
    rows.initialize(refilled.setup(), &position);
    if (!criterion.is_on())
      return;
    reference.reinit_like(position);
    reference.copy_from(position);
    reference.update_ghosts();
  }

  template <int dim>
  std::vector<unsigned int>
  SmoothedCells<dim>::find_converting_cells(const NodalVector &position) const
  {
    std::vector<bool> converts(cells.n_present_cells(), false);
    mark_by_points(criterion, points(), n_points_per_cell(), converts);
    mark_by_shape(criterion, cells, 1, position, converts);
    std::vector<double> time_steps;
    if (criterion.time_step())
      courant_limits(position, time_steps);
    for (unsigned int place = 0; place < converts.size() && criterion.time_step(); ++place)
      if (!(time_steps[cells.cell_at(place)] >= *criterion.time_step()))
        converts[place] = true;
    return cells_at(cells, converts);
  }

  template <int dim>
  void SmoothedCells<dim>::add_state(const std::vector<unsigned int> &converted,
                                     StateTransfer &state) const
  {
    add_state_of_cells(cells, points(), integration.heating(), material().density(),
                       rows.corner_shares(), converted, state);
  }

  template <int dim>
  void SmoothedCells<dim>::take_converted_cells(const std::vector<unsigned int> &converted)
  {
    lost_cells.convert(converted, n_cells());
    set_void_cells(lost_cells.flags());
    refilled.take_masses(cells);
    // Functions of the cells that are left end where those are that have become particles.
    rows.initialize(refilled.setup(), reference.partition() != nullptr ? &reference : nullptr);
  }

  template <int dim>
  SmoothedPointState<dim> SmoothedCells<dim>::point_state()
  {
    return {integration.points(), integration.material().density(), integration.heating(), rows,
            cells};
  }

  template <int dim>
  void SmoothedCells<dim>::serialize(StateArchive &archive)
  {
    if (criterion.is_on())
      lost_cells.serialize(n_cells(), heat != nullptr, archive);
    if (!refill().is_on())
      return;
    std::vector<double> masses = masses_of_cells();
    archive.rows("mass of corners", n_corners, masses);
    if (archive.is_reading())
      cells.set_masses(masses);
  }

  template class SmoothedCells<2>;
  template class SmoothedCells<3>;
} // namespace tombolo
