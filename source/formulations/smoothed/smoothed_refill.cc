// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** F of a row. */
    template <int dim>
    Tensor<2, dim> deformation_of_row(const Stencils &stencils, const unsigned int number,
                                      const NodalVector &position)
    {
      const Stencils::Row row = stencils.row(number);
      const double *const origin = position.node(stencils.particle_node[number]);
      Tensor<2, dim> result;
      for (unsigned int k = 0; k < row.size; ++k)
      {
        const double *const x = position.node(row.neighbour[k]);
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            result[a][b] += (x[a] - origin[a]) * row.gradient[k * Stencils::n_gradient + b];
      }
      return result;
    }
  } // namespace

  template <int dim>
  const RefillSettings &SmoothedCells<dim>::refill() const
  {
    return refill_settings;
  }

  template <int dim>
  void SmoothedCells<dim>::prepare_refills(const PartSetup<dim> &setup)
  {
    if (!setup.has_mechanics)
      refill_settings.refuse("the scene has no mechanics, since its materials have no stresses; "
                             "nothing is deformed.");
    if (setup.scales_inertia)
      refill_settings.refuse("the mass of single cells is scaled (\"Scaling/Target time step\"), "
                             "which a refill would mix; allowed is a uniform \"Mass factor\".");
    bool is_graded = false;
    for (const SmoothedCell<dim> &cell : smoothed_cells_of(setup))
      is_graded = is_graded || !cell.refined_faces.empty();
    if (Utilities::MPI::max(is_graded ? 1 : 0, setup.communicator) != 0)
      refill_settings.refuse("the part has cells beside cells of half their size (`Refine where`); "
                             "allowed are parts without such faces.");
    part_setup = setup;
    rows.prepare_positions();
  }

  template <int dim>
  std::vector<unsigned int> SmoothedCells<dim>::distorted_cells(const NodalVector &position) const
  {
    std::vector<unsigned int> result;
    const double limit = refill_settings.stretch() * refill_settings.stretch();
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
    {
      bool is_distorted = false;
      for (unsigned int q = 0; q < n_points_per_cell() && !is_distorted; ++q)
      {
        const Tensor<2, dim> f =
            deformation_of_row<dim>(rows.stencils(), point_of_cell(cell, q), position);
        const auto squares = eigenvalues(symmetrize(transpose(f) * f)); // descending
        is_distorted = determinant(f) <= refill_settings.volume_ratio() ||
                       squares[0] > limit * squares[dim - 1];
      }
      if (is_distorted)
        result.push_back(cell);
    }
    return result;
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
    rows.initialize(part_setup, &position);
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
    if (!refill_settings.is_on())
      return;
    std::vector<double> masses = masses_of_cells();
    archive.rows("mass of corners", n_corners, masses);
    if (archive.is_reading())
      cells.set_masses(masses);
  }

  template class SmoothedCells<2>;
  template class SmoothedCells<3>;
} // namespace tombolo
