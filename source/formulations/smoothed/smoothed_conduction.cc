// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_conduction.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/row_block.h>

#include <deal.II/base/tensor.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void add_smoothed_conduction(const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells,
                               const TemperatureTable &conductivity, const NodalVector &position,
                               const NodalVector &of_conductivity, const NodalVector &temperature,
                               NodalVector &heat_rate)
  {
    if (conductivity.largest() == 0.)
      return;
    const Stencils &stencils = rows.stencils();
    const unsigned int n_points = rows.n_points_per_cell();
    std::vector<double> at_points(std::size_t(n_points) * n_lanes);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      rows.interpolate(cells.nodes(batch), of_conductivity, at_points.data());
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const unsigned int number = (batch * n_points + q) * n_lanes + lane;
          const Stencils::Row row = stencils.row(number);
          const unsigned int origin = stencils.particle_node[number];
          NodeLanes columns[3] = {0., 0., 0.};
          RowBlock::add_row(row, position.data(),
                            load_node(RowBlock::node(position.data(), origin)), columns);
          Tensor<1, dim> gradient;
          Tensor<2, dim> deformation;
          for (unsigned int k = 0; k < row.size; ++k)
            for (unsigned int a = 0; a < dim; ++a)
              gradient[a] += row.gradient[k * Stencils::n_gradient + a] *
                             (*temperature.node(row.neighbour[k]) - *temperature.node(origin));
          for (unsigned int a = 0; a < dim; ++a)
            for (unsigned int b = 0; b < dim; ++b)
              deformation[a][b] = columns[b][a];
          const Tensor<2, dim> inverse_deformation = invert(deformation);
          const Tensor<1, dim> flux =
              rows.volumes()[number] * determinant(deformation) *
              conductivity.value(at_points[q * n_lanes + lane]) *
              (inverse_deformation * (transpose(inverse_deformation) * gradient));
          for (unsigned int k = 0; k < row.size; ++k)
            for (unsigned int a = 0; a < dim; ++a)
              *heat_rate.node(row.neighbour[k]) -=
                  flux[a] * row.gradient[k * Stencils::n_gradient + a];
        }
    }
  }

  template void add_smoothed_conduction<2>(const SmoothedGradients<2> &, const CellBatches<2> &,
                                           const TemperatureTable &, const NodalVector &,
                                           const NodalVector &, const NodalVector &, NodalVector &);
  template void add_smoothed_conduction<3>(const SmoothedGradients<3> &, const CellBatches<3> &,
                                           const TemperatureTable &, const NodalVector &,
                                           const NodalVector &, const NodalVector &, NodalVector &);
} // namespace tombolo
