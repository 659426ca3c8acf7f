// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

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
    std::vector<Point<dim>> of_cells;
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int q = 0; q < n_points; ++q)
        of_cells.push_back(initial_points[point_of_cell(cell, q)]);
    cells.remove(void_cells().of_cells());
    initial_points.assign(std::size_t(cells.n_batches_of_places()) * n_points * n_lanes,
                          Point<dim>());
    auto place = of_cells.begin();
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int q = 0; q < n_points; ++q)
        initial_points[point_of_cell(cell, q)] = *place++;
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
  void SmoothedCells<dim>::set_masses(const std::vector<double> &of_cells)
  {
    cells.set_masses(of_cells);
  }

  template <int dim>
  void SmoothedCells<dim>::renew_reference(const NodalVector &position)
  {
    rows.initialize(refilled.setup(), &position);
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
