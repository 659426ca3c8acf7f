// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_stiffness.h>

#include <tombolo/formulations/row_stiffness.h>

#include <algorithm>
#include <array>
#include <memory>

namespace tombolo
{
  namespace
  {
    template <int dim, unsigned int n_points>
    void find_equations_of_points(const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells,
                                  const RowMaterial &material, const MechanicalInput &input,
                                  const std::function<void(const CellEquations &)> &take)
    {
      using Stiffness = RowStiffness<dim, n_points>;
      constexpr unsigned int batch_size = n_points * n_lanes;
      const auto stiffness = std::make_unique<Stiffness>(material, input.time_increment);
      const Stencils &stencils = rows.stencils();
      alignas(64) double temperature[batch_size];
      typename Stiffness::Gradients gradients;
      for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
      {
        const std::size_t first = std::size_t(batch) * batch_size;
        for (unsigned int q = 0; q < n_points; ++q)
        {
          RowBlock::gather_gradients<dim>(stencils, first + q * n_lanes, n_lanes,
                                          input.position->data(), input.velocity->data(),
                                          gradients.deformation[q], gradients.displacement[q]);
          for (Lanes &entry : gradients.displacement[q].entry)
            entry *= input.time_increment;
          gradients.volume[q] = load_lanes(rows.volumes().data() + first + q * n_lanes);
        }
        if (material.plastic_heating->is_on())
          rows.interpolate(cells.nodes(batch), *input.temperature, temperature);
        stiffness->find(first, gradients, temperature);
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          std::array<Stencils::Row, n_points> of_cell{};
          for (unsigned int q = 0; q < n_points; ++q)
            of_cell[q] = stencils.row(static_cast<unsigned int>(first) + q * n_lanes + lane);
          stiffness->hand_over(lane, of_cell, take);
        }
      }
    }
  } // namespace

  template <int dim>
  void find_smoothed_equations(const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells,
                               const RowMaterial &material, const MechanicalInput &input,
                               const std::function<void(const CellEquations &)> &take)
  {
    switch (rows.n_points_per_cell())
    {
    case 1:
      return find_equations_of_points<dim, 1>(rows, cells, material, input, take);
    case 4:
      return find_equations_of_points<dim, 4>(rows, cells, material, input, take);
    default:
      if constexpr (dim == 3)
        find_equations_of_points<dim, 8>(rows, cells, material, input, take);
    }
  }

  template <int dim>
  void find_smoothed_couplings(const SmoothedGradients<dim> &rows, const unsigned int n_cells,
                               const NodeGroupAction &use)
  {
    const unsigned int n_points = rows.n_points_per_cell();
    std::vector<unsigned int> group;
    for (unsigned int cell = 0; cell < n_cells; ++cell)
    {
      group.clear();
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Stencils::Row row = rows.stencils().row(point_in_lanes(cell, n_points, q));
        group.insert(group.end(), row.neighbour, row.neighbour + row.size);
      }
      std::sort(group.begin(), group.end());
      group.erase(std::unique(group.begin(), group.end()), group.end());
      use(group);
    }
  }

  template void find_smoothed_equations<2>(const SmoothedGradients<2> &, const CellBatches<2> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);
  template void find_smoothed_equations<3>(const SmoothedGradients<3> &, const CellBatches<3> &,
                                           const RowMaterial &, const MechanicalInput &,
                                           const std::function<void(const CellEquations &)> &);
  template void find_smoothed_couplings<2>(const SmoothedGradients<2> &, unsigned int,
                                           const NodeGroupAction &);
  template void find_smoothed_couplings<3>(const SmoothedGradients<3> &, unsigned int,
                                           const NodeGroupAction &);
} // namespace tombolo
