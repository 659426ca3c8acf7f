// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/refilled_cells.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/formulations/smoothed/node_cloud.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  const PartSetup<dim> &RefilledCells<dim>::initialize(const PartSetup<dim> &of_part)
  {
    part_setup = of_part;
    if (!refill_settings.is_on())
      return part_setup;
    if (!of_part.has_mechanics)
      refill_settings.refuse("the scene has no mechanics, since its materials have no stresses; "
                             "nothing is deformed.");
    if (of_part.scales_inertia)
      refill_settings.refuse("the mass of single cells is scaled (\"Scaling/Target time step\"), "
                             "which a refill would mix; allowed is a uniform \"Mass factor\".");
    bool is_graded = false;
    for (const SmoothedCell<dim> &cell : smoothed_cells_of(of_part))
      is_graded = is_graded || !cell.refined_faces.empty();
    if (Utilities::MPI::max(is_graded ? 1 : 0, of_part.communicator) != 0)
      refill_settings.refuse("the part has cells beside cells of half their size (`Refine where`); "
                             "allowed are parts without such faces.");
    const auto is_void = refill_settings.template void_cells<dim>();
    if (!is_void)
      return part_setup;
    if (of_part.symmetry)
      refill_settings.refuse_void_cells("the scene has planes of symmetry, at which cells are "
                                        "neither filled nor emptied; allowed is the whole body.");
    voids.initialize(of_part, *is_void);
    part_setup.void_cells = &voids;
    const auto &flags = voids.of_cells();
    const bool has_full = std::find(flags.begin(), flags.end(), false) != flags.end();
    if (Utilities::MPI::max(has_full ? 1 : 0, of_part.communicator) == 0)
      refill_settings.refuse_void_cells("all cells of the part are void; allowed is a predicate "
                                        "that is false at the centre of some.");
    return part_setup;
  }

  template <int dim>
  void RefilledCells<dim>::take_masses(CellBatches<dim> &cells) const
  {
    std::vector<double> masses;
    for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      for (unsigned int k = 0; k < cells.n_nodes_per_cell(); ++k)
        masses.push_back(voids.of_cells()[cell] ? 0. : cells.mass_of_node(cell, k));
    cells.set_masses(masses);
  }

  template <int dim>
  bool RefilledCells<dim>::is_distorted(const Stencils &rows,
                                        const std::vector<unsigned int> &points,
                                        const NodalVector &position) const
  {
    const double limit = refill_settings.stretch() * refill_settings.stretch();
    return std::any_of(points.begin(), points.end(),
                       [&](const unsigned int point)
                       {
                         const Tensor<2, dim> f = row_deformation<dim>(rows, point, position);
                         const auto squares = eigenvalues(symmetrize(transpose(f) * f)); // falling
                         return determinant(f) <= refill_settings.volume_ratio() ||
                                squares[0] > limit * squares[dim - 1];
                       });
  }

  template class RefilledCells<2>;
  template class RefilledCells<3>;
} // namespace tombolo
