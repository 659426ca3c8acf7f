// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The members of CellFormulation that have to do with heat; included at its end.
#include <tombolo/formulations/elements/cell_formulation.h>

namespace tombolo
{
  template <int dim, typename Element>
  void CellFormulation<dim, Element>::interpolate_temperature(const unsigned int batch,
                                                              const NodalVector &temperature,
                                                              double *const at_points) const
  {
    ScalarValues values;
    gather(batch, temperature, values);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Lanes sum = shape_values[q][0] * values[0];
      for (unsigned int k = 1; k < n_nodes; ++k)
        sum += shape_values[q][k] * values[k];
      store_lanes(sum, at_points + q * n_lanes);
    }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_conduction(const NodalVector &position,
                                                     const NodalVector &of_conductivity,
                                                     const NodalVector &temperature,
                                                     NodalVector &heat_rate) const
  {
    Assert(thermal_properties != nullptr, dealii::ExcInternalError());
    const TemperatureTable &table = thermal_properties->conductivity();
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
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      NodeValues x;
      ScalarValues at, theta, rate;
      gather(batch, position, x);
      gather(batch, of_conductivity, at);
      gather(batch, temperature, theta);
      for (unsigned int k = 0; k < n_nodes; ++k)
        rate[k] = 0.;
      ConductionElement<dim, Element::degree>::add_conduction(x, at, theta, conductivity, rate);
      const unsigned int *const nodes = cells.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
          *heat_rate.node(nodes[k * n_lanes + lane]) += rate[k][lane];
    }
  }

  template <int dim, typename Element>
  StepLimit CellFormulation<dim, Element>::diffusion_limit(const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "cell";
    const double diffusivity = thermal_properties->largest_diffusivity() / part_material->density();
    if (diffusivity == 0.)
      return limit;
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      NodeValues x;
      gather(batch, position, x);
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
      {
        // Conduction is stiff along the shortest distance between nodes.
        double shortest = 1e300;
        for (unsigned int k = 0; k < n_nodes; ++k)
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
          limit.place = centre(x, lane);
        }
      }
    }
    return limit;
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_plastic_heat(NodalVector &heat)
  {
    if (!plastic_heating.has_plastic_heat())
      return;
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      const unsigned int *const nodes = cells.nodes(batch);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const double given =
              plastic_heating.give(material_points, (batch * n_points + q) * n_lanes + lane);
          for (unsigned int k = 0; k < n_nodes; ++k)
            *heat.node(nodes[k * n_lanes + lane]) += shape_values[q][k] * given;
        }
    }
  }
} // namespace tombolo
