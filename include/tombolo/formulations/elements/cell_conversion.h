// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The members of CellFormulation that have to do with cells that become particles; included at its
// end.
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/mesh/cell_quality.h>

namespace tombolo
{
  template <int dim, typename Element>
  std::vector<unsigned int>
  CellFormulation<dim, Element>::find_converting_cells(const NodalVector &position) const
  {
    std::vector<unsigned int> result;
    const unsigned int n_present = cells.n_present_cells();
    std::vector<bool> converts(n_present, false);
    if (criterion.strain())
    {
      const double *const strains = criterion.plastic_strain(material_points);
      for (unsigned int place = 0; place < n_present; ++place)
      {
        double strain = 0;
        for (unsigned int q = 0; q < n_points; ++q)
          strain += strains[point_at(place, q)];
        converts[place] = strain >= n_points * *criterion.strain();
      }
    }
    if (criterion.time_step())
      for_crossing_times(position,
                         [&](const unsigned int batch, const NodeValues &, const Lanes &time)
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

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_state(const std::vector<unsigned int> &converted,
                                                StateTransfer &state) const
  {
    const double inverse_density = 1. / part_material->density();
    for (const unsigned int cell : converted)
    {
      const unsigned int place = cells.place(cell);
      const unsigned int *const nodes = cells.nodes(place / n_lanes) + place % n_lanes;
      for (unsigned int k = 0; k < n_nodes; ++k)
      {
        const unsigned int node = nodes[k * n_lanes];
        const double volume = inverse_density * cells.mass_of_node(cell, k);
        double weights[n_points];
        double sum = 0, pending = 0;
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int point = point_at(place, q);
          weights[q] = shape_values[q][k] *
                       material_points.component(MaterialPoints::volume, 0)[point] /
                       material_points.component(MaterialPoints::volume_ratio, 0)[point];
          sum += weights[q];
          if (plastic_heating.has_plastic_heat())
            pending += shape_values[q][k] * plastic_heating.pending(material_points, point);
        }
        *state.volume.node(node) += volume;
        *state.pending_heat.node(node) += pending;
        for (StateTransfer::Component &component : state.components)
        {
          const double *const values =
              material_points.component(component.source_field, component.number);
          double mean = 0;
          for (unsigned int q = 0; q < n_points; ++q)
            mean += weights[q] * values[point_at(place, q)];
          *component.sum.node(node) += volume * mean / sum;
        }
      }
    }
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::deactivate_cells(const std::vector<unsigned int> &given)
  {
    if (given.empty())
      return;
    removed.resize(cells.n_cells(), false);
    converted.resize(cells.n_cells(), false);
    for (const unsigned int cell : given)
      removed[cell] = converted[cell] = true;
    close_up();
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::keep_dissipated(const EnergyAccounts &lost)
  {
    for (const EnergyAccounts::Account &account : lost.accounts())
      if (account.kind != EnergyKind::stored && account.name != "failure dissipation")
        dissipated_in_removed.add(account.name, account.kind, account.value);
  }

  template <int dim, typename Element>
  unsigned int CellFormulation<dim, Element>::n_converted_cells() const
  {
    return static_cast<unsigned int>(std::count(converted.begin(), converted.end(), true));
  }
} // namespace tombolo
