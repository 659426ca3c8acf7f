// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/conduction_element.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/materials/thermal_properties.h>

#include <algorithm>

namespace tombolo
{
  /** Formulation::add_conduction() of cells with the conductivity of @p properties. */
  template <int dim, typename Element>
  void add_conduction_of_cells(const CellPoints<dim, Element> &points,
                               const ThermalProperties &properties, const NodalVector &position,
                               const NodalVector &of_conductivity, const NodalVector &temperature,
                               NodalVector &heat_rate)
  {
    using Points = CellPoints<dim, Element>;
    const TemperatureTable &table = properties.conductivity();
    if (table.largest() == 0.)
      return;
    const double constant = table.value(0.);
    const auto conductivity = [&](const Lanes &at) -> Lanes
    {
      if (table.is_constant())
        return constant;
      alignas(64) double temperatures[n_lanes], values[n_lanes];
      store_lanes(at, temperatures);
      table.evaluate(n_lanes, temperatures, values);
      return load_lanes(values);
    };
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      typename Points::ScalarValues at, theta, rate;
      points.gather(batch, position, x);
      points.gather(batch, of_conductivity, at);
      points.gather(batch, temperature, theta);
      for (unsigned int k = 0; k < Points::n_nodes; ++k)
        rate[k] = 0.;
      ConductionElement<dim, Element::degree>::add_conduction(x, at, theta, conductivity, rate);
      const unsigned int *const nodes = points.cells().nodes(batch);
      for (unsigned int k = 0; k < Points::n_nodes; ++k)
        for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
          *heat_rate.node(nodes[k * n_lanes + lane]) += rate[k][lane];
    }
  }

  /** Formulation::diffusion_limit() of cells with this largest @p diffusivity [L^2/T]: conduction
   * is stiff along the shortest distance between nodes. */
  template <int dim>
  StepLimit diffusion_limit_of_cells(const CellBatches<dim> &cells, const double diffusivity,
                                     const NodalVector &position)
  {
    const unsigned int n_nodes = cells.n_nodes_per_cell();
    StepLimit limit;
    limit.entity = "cell";
    for (unsigned int batch = 0; batch < cells.n_batches() && diffusivity != 0.; ++batch)
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
      {
        const auto node = [&](const unsigned int k)
        { return position.node(cells.nodes(batch)[k * n_lanes + lane]); };
        double shortest = 1e300;
        dealii::Point<3> centre;
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          for (unsigned int other = 0; other < k; ++other)
          {
            double squared = 0;
            for (unsigned int d = 0; d < dim; ++d)
              squared += (node(k)[d] - node(other)[d]) * (node(k)[d] - node(other)[d]);
            shortest = std::min(shortest, squared);
          }
          for (unsigned int d = 0; d < dim; ++d)
            centre[d] += node(k)[d] / n_nodes;
        }
        if (shortest / (2. * diffusivity) < limit.time_step)
        {
          limit.time_step = shortest / (2. * diffusivity);
          limit.place = centre;
        }
      }
    return limit;
  }
} // namespace tombolo
