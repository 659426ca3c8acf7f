// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/cell_conversion.h>

#include <tombolo/mesh/cell_quality.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

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
  std::vector<unsigned int> cells_at(const CellBatches<dim> &cells,
                                     const std::vector<bool> &converts)
  {
    std::vector<unsigned int> result;
    for (unsigned int place = 0; place < converts.size(); ++place)
      if (converts[place])
        result.push_back(cells.cell_at(place));
    return result;
  }

  template <int dim>
  void add_state_of_cells(const CellBatches<dim> &cells, const MaterialPoints &points,
                          const PlasticHeating &plastic_heating, const double density,
                          const std::vector<std::vector<double>> &shape_values,
                          const std::vector<unsigned int> &converted, StateTransfer &state)
  {
    const auto n_points = static_cast<unsigned int>(shape_values.size());
    const double inverse_density = 1. / density;
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
          if (plastic_heating.has_plastic_heat())
            pending += shape_values[q][k] * plastic_heating.pending(points, point);
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

  template <int dim>
  std::vector<unsigned int> remove_cells(const std::vector<bool> &is_removed,
                                         const unsigned int n_points, CellBatches<dim> &cells,
                                         MaterialPoints &points)
  {
    const unsigned int n_places = cells.n_batches_of_places() * n_lanes;
    std::vector<unsigned int> from(n_places, 0), old_place(cells.n_cells());
    for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      old_place[cell] = cells.place(cell);
    cells.remove(is_removed);
    for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      from[cells.place(cell)] = old_place[cell];
    const unsigned int n_present = cells.n_present_cells();
    for (unsigned int place = n_present; place < padded_to_lanes(n_present); ++place)
      from[place] = from[n_present - 1];

    if (points.size() == 0) // they are not made yet
      return from;
    std::vector<double> old(points.size());
    for (unsigned int f = 0; f < points.fields().size(); ++f)
      for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
      {
        double *const values = points.component(f, c);
        std::copy_n(values, old.size(), old.begin());
        for (unsigned int place = 0; place < n_places; ++place)
          for (unsigned int q = 0; q < n_points; ++q)
            values[point_in_lanes(place, n_points, q)] =
                old[point_in_lanes(from[place], n_points, q)];
      }
    for (unsigned int place = n_present; place < n_places; ++place)
      for (unsigned int q = 0; q < n_points; ++q)
      {
        points.component(MaterialPoints::volume, 0)[point_in_lanes(place, n_points, q)] = 0.;
        points.component(MaterialPoints::volume_ratio, 0)[point_in_lanes(place, n_points, q)] = 1.;
      }
    return from;
  }

  template void mark_by_shape(const ConversionCriterion &, const CellBatches<2> &, unsigned int,
                              const NodalVector &, std::vector<bool> &);
  template void mark_by_shape(const ConversionCriterion &, const CellBatches<3> &, unsigned int,
                              const NodalVector &, std::vector<bool> &);
  template std::vector<unsigned int> cells_at(const CellBatches<2> &, const std::vector<bool> &);
  template std::vector<unsigned int> cells_at(const CellBatches<3> &, const std::vector<bool> &);
  template void add_state_of_cells(const CellBatches<2> &, const MaterialPoints &,
                                   const PlasticHeating &, double,
                                   const std::vector<std::vector<double>> &,
                                   const std::vector<unsigned int> &, StateTransfer &);
  template void add_state_of_cells(const CellBatches<3> &, const MaterialPoints &,
                                   const PlasticHeating &, double,
                                   const std::vector<std::vector<double>> &,
                                   const std::vector<unsigned int> &, StateTransfer &);
  template std::vector<unsigned int> remove_cells(const std::vector<bool> &, unsigned int,
                                                  CellBatches<2> &, MaterialPoints &);
  template std::vector<unsigned int> remove_cells(const std::vector<bool> &, unsigned int,
                                                  CellBatches<3> &, MaterialPoints &);
} // namespace tombolo
