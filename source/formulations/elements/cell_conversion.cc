// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_conversion.h>

#include <tombolo/mesh/cell_quality.h>

namespace tombolo
{
  void mark_by_points(const ConversionCriterion &criterion, const MaterialPoints &points,
                      const unsigned int n_points, std::vector<bool> &converts)
  {
    const auto compare_means = [&](const double *const values, const double limit)
    {
      for (unsigned int place = 0; place < converts.size(); ++place)
      {
        double sum = 0;
        for (unsigned int q = 0; q < n_points; ++q)
          sum += values[point_in_lanes(place, n_points, q)];
        if (sum >= n_points * limit)
          converts[place] = true;
      }
    };
    if (criterion.strain())
      compare_means(criterion.plastic_strain(points), *criterion.strain());
    if (criterion.damage())
      compare_means(criterion.damage(points), *criterion.damage());
  }

  template <int dim>
  void mark_by_shape(const ConversionCriterion &criterion, const CellBatches<dim> &cells,
                     const unsigned int degree, const NodalVector &position,
                     std::vector<bool> &converts)
  {
    CellVertices<dim> vertices;
    for (unsigned int place = 0; place < converts.size() && criterion.scaled_jacobian(); ++place)
    {
      const unsigned int *const nodes = cells.nodes(place / n_lanes);
      for (unsigned int corner = 0; corner < vertices.size(); ++corner)
      {
        unsigned int k = 0, stride = 1;
        for (unsigned int d = 0; d < dim; ++d, stride *= degree + 1)
          k += ((corner >> d) & 1u) * degree * stride;
        const double *const x = position.node(nodes[k * n_lanes + place % n_lanes]);
        for (unsigned int d = 0; d < dim; ++d)
          vertices[corner][d] = x[d];
      }
      if (!(smallest_corner<dim>(vertices) >= *criterion.scaled_jacobian()))
        converts[place] = true;
    }
  }

  template <int dim>
  void add_state_of_cells(const PointsInCells<dim> &cell_points, const PartPoints &part_points,
                          const std::vector<unsigned int> &converted, StateTransfer &state)
  {
    const CellBatches<dim> &cells = cell_points.cells();
    const MaterialPoints &points = part_points.points();
    const PlasticHeating &heating = part_points.heating();
    const std::vector<std::vector<double>> &shape_values = cell_points.shape_values_at_points();
    const unsigned int n_points = cell_points.n_points_per_cell();
    const double inverse_density = 1. / part_points.material().density();
    const double *const volumes = points.component(MaterialPoints::volume, 0);
    const double *const ratios = points.component(MaterialPoints::volume_ratio, 0);
    std::vector<double> weights(n_points);
    for (const unsigned int cell : converted)
    {
      const unsigned int place = cells.place(cell);
      const unsigned int *const nodes = cells.nodes(place / n_lanes) + place % n_lanes;
      for (unsigned int k = 0; k < cells.n_nodes_per_cell(); ++k)
      {
        const unsigned int node = nodes[k * n_lanes];
        const double volume = inverse_density * cells.mass_of_node(cell, k);
        double sum = 0, pending = 0;
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int point = point_in_lanes(place, n_points, q);
          weights[q] = shape_values[q][k] * volumes[point] / ratios[point];
          sum += weights[q];
          if (heating.has_plastic_heat())
            pending += shape_values[q][k] * heating.pending(points, point);
        }
        *state.volume.node(node) += volume;
        *state.pending_heat.node(node) += pending;
        for (StateTransfer::Component &component : state.components)
        {
          const double *const values = points.component(component.source_field, component.number);
          double mean = 0;
          for (unsigned int q = 0; q < n_points; ++q)
            mean += weights[q] * values[point_in_lanes(place, n_points, q)];
          *component.sum.node(node) += volume * mean / sum;
        }
      }
    }
  }

  template void mark_by_shape(const ConversionCriterion &, const CellBatches<2> &, unsigned int,
                              const NodalVector &, std::vector<bool> &);
  template void mark_by_shape(const ConversionCriterion &, const CellBatches<3> &, unsigned int,
                              const NodalVector &, std::vector<bool> &);
  template void add_state_of_cells(const PointsInCells<2> &, const PartPoints &,
                                   const std::vector<unsigned int> &, StateTransfer &);
  template void add_state_of_cells(const PointsInCells<3> &, const PartPoints &,
                                   const std::vector<unsigned int> &, StateTransfer &);
} // namespace tombolo
