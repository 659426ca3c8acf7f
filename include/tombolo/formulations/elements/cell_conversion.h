// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_inertia.h>
#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/conversion_criterion.h>
#include <tombolo/formulations/elements/converting_cells.h>
#include <tombolo/mesh/cell_quality.h>

#include <vector>

namespace tombolo
{
  /** ConvertingCells::find_converting_cells() by @p criterion. */
  template <int dim, typename Element>
  std::vector<unsigned int> find_cells_to_convert(const CellPoints<dim, Element> &points,
                                                  const CellIntegration<dim, Element> &integration,
                                                  const ConversionCriterion &criterion,
                                                  const NodalVector &position)
  {
    using Points = CellPoints<dim, Element>;
    const CellBatches<dim> &cells = points.cells();
    std::vector<unsigned int> result;
    const unsigned int n_present = cells.n_present_cells();
    std::vector<bool> converts(n_present, false);
    const auto compare_means = [&](const double *const values, const double limit)
    {
      for (unsigned int place = 0; place < n_present; ++place)
      {
        double sum = 0;
        for (unsigned int q = 0; q < Points::n_points; ++q)
          sum += values[Points::point_at(place, q)];
        if (sum >= Points::n_points * limit)
          converts[place] = true;
      }
    };
    if (criterion.strain())
      compare_means(criterion.plastic_strain(points.material_points()), *criterion.strain());
    if (criterion.damage())
      compare_means(criterion.damage(points.material_points()), *criterion.damage());
    if (criterion.time_step())
      for_crossing_times(
          points, integration, position,
          [&](const unsigned int batch, const typename Points::NodeValues &, const Lanes &time)
          {
            for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
              if (!(time[lane] >= *criterion.time_step()))
                converts[batch * n_lanes + lane] = true;
          });
    if (criterion.scaled_jacobian())
    {
      CellVertices<dim> vertices;
      for (unsigned int place = 0; place < n_present; ++place)
      {
        const unsigned int *const nodes = cells.nodes(place / n_lanes);
        for (unsigned int corner = 0; corner < vertices.size(); ++corner)
        {
          unsigned int k = 0, stride = 1;
          for (unsigned int d = 0; d < dim; ++d, stride *= Element::degree + 1)
            k += ((corner >> d) & 1u) * Element::degree * stride;
          const double *const x = position.node(nodes[k * n_lanes + place % n_lanes]);
          for (unsigned int d = 0; d < dim; ++d)
            vertices[corner][d] = x[d];
        }
        if (!(smallest_corner<dim>(vertices) >= *criterion.scaled_jacobian()))
          converts[place] = true;
      }
    }
    for (unsigned int place = 0; place < n_present; ++place)
      if (converts[place])
        result.push_back(cells.cell_at(place));
    return result;
  }

  /** ConvertingCells::add_state() of cells with these points. */
  template <int dim, typename Element>
  void add_state_of_cells(const CellPoints<dim, Element> &points,
                          const CellIntegration<dim, Element> &integration,
                          const std::vector<unsigned int> &converted, StateTransfer &state)
  {
    using Points = CellPoints<dim, Element>;
    constexpr unsigned int n_points = Points::n_points;
    const CellBatches<dim> &cells = points.cells();
    const MaterialPoints &material_points = points.material_points();
    const PlasticHeating &plastic_heating = integration.heating();
    const double inverse_density = 1. / integration.material().density();
    for (const unsigned int cell : converted)
    {
      const unsigned int place = cells.place(cell);
      const unsigned int *const nodes = cells.nodes(place / n_lanes) + place % n_lanes;
      for (unsigned int k = 0; k < Points::n_nodes; ++k)
      {
        const unsigned int node = nodes[k * n_lanes];
        const double volume = inverse_density * cells.mass_of_node(cell, k);
        double weights[n_points];
        double sum = 0, pending = 0;
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int point = Points::point_at(place, q);
          weights[q] = points.shape_value(q, k) *
                       material_points.component(MaterialPoints::volume, 0)[point] /
                       material_points.component(MaterialPoints::volume_ratio, 0)[point];
          sum += weights[q];
          if (plastic_heating.has_plastic_heat())
            pending += points.shape_value(q, k) * plastic_heating.pending(material_points, point);
        }
        *state.volume.node(node) += volume;
        *state.pending_heat.node(node) += pending;
        for (StateTransfer::Component &component : state.components)
        {
          const double *const values =
              material_points.component(component.source_field, component.number);
          double mean = 0;
          for (unsigned int q = 0; q < n_points; ++q)
            mean += weights[q] * values[Points::point_at(place, q)];
          *component.sum.node(node) += volume * mean / sum;
        }
      }
    }
  }
} // namespace tombolo
