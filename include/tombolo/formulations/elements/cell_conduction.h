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

  /** Formulation::diffusion_limit() of cells with this largest @p diffusivity [L^2/T]. */
  template <int dim, typename Element>
  StepLimit diffusion_limit_of_cells(const CellPoints<dim, Element> &points,
                                     const double diffusivity, const NodalVector &position)
  {
    using Points = CellPoints<dim, Element>;
    StepLimit limit;
    limit.entity = "cell";
    if (diffusivity == 0.)
      return limit;
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      points.gather(batch, position, x);
      for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
      {
        // Conduction is stiff along the shortest distance between nodes.
        double shortest = 1e300;
        for (unsigned int k = 0; k < Points::n_nodes; ++k)
          for (unsigned int other = 0; other < k; ++other)
          {
            double squared = 0;
            for (unsigned int d = 0; d < dim; ++d)
              squared += (x[k][d][lane] - x[other][d][lane]) * (x[k][d][lane] - x[other][d][lane]);
            shortest = std::min(shortest, squared);
          }
        if (shortest / (2. * diffusivity) < limit.time_step)
        {
          limit.time_step = shortest / (2. * diffusivity);
          limit.place = Points::centre(x, lane);
        }
      }
    }
    return limit;
  }
} // namespace tombolo
