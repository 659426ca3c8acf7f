// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/losing_cells.h>

#include <tombolo/mesh/cell_quality.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** What is dissipated in cells that are lost; particles that cells become have further
     * accounts. */
    constexpr std::array<std::pair<std::string_view, EnergyKind>, 3> kept = {
        {{"plastic dissipation", EnergyKind::dissipated},
         {"viscous dissipation", EnergyKind::artificial},
         {"thermal work", EnergyKind::external}}};
  } // namespace

  unsigned int LostCells::n_converted() const
  {
    return static_cast<unsigned int>(std::count(converted.begin(), converted.end(), true));
  }

  void LostCells::remove(const std::vector<unsigned int> &cells, const unsigned int n_cells)
  {
    lost.resize(n_cells, false);
    for (const unsigned int cell : cells)
      lost[cell] = true;
  }

  void LostCells::convert(const std::vector<unsigned int> &cells, const unsigned int n_cells)
  {
    lost.resize(n_cells, false);
    converted.resize(n_cells, false);
    for (const unsigned int cell : cells)
      lost[cell] = converted[cell] = true;
  }

  void LostCells::keep_dissipated(const EnergyAccounts &of_cells)
  {
    for (const EnergyAccounts::Account &account : of_cells.accounts())
      if (std::any_of(kept.begin(), kept.end(),
                      [&](const auto &of_cell) { return of_cell.first == account.name; }))
        dissipated_in_lost.add(account.name, account.kind, account.value);
  }

  bool LostCells::serialize(const unsigned int n_cells, const bool has_heat, StateArchive &archive)
  {
    constexpr double present = 0., eroded = 1., became_particles = 2.;
    std::vector<double> flags(n_cells, present);
    for (unsigned int cell = 0; cell < n_cells; ++cell)
      if (is_lost(cell))
        flags[cell] = is_converted(cell) ? became_particles : eroded;
    archive.rows("is removed", 1, flags);
    std::array<double, kept.size()> values;
    for (std::size_t k = 0; k < kept.size(); ++k)
      values[k] = dissipated_in_lost[std::string(kept[k].first)];
    archive.sums("dissipated in removed cells", {&values[0], &values[1], &values[2]});
    if (!archive.is_reading())
      return false;
    dissipated_in_lost = EnergyAccounts();
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (has_heat || kept[k].second != EnergyKind::external)
        dissipated_in_lost.add(std::string(kept[k].first), kept[k].second, values[k]);
    lost.clear();
    converted.clear();
    if (std::all_of(flags.begin(), flags.end(), [](const double flag) { return flag == present; }))
      return false;
    for (const double flag : flags)
    {
      lost.push_back(flag != present);
      converted.push_back(flag == became_particles);
    }
    return true;
  }

  template <int dim>
  void mark_by_shape(const ConversionCriterion &criterion, const CellBatches<dim> &cells,
                     const unsigned int degree, const NodalVector &position,
                     std::vector<bool> &converts)
  {
    CellVertices<dim> vertices;
    for (unsigned int place = 0; place < converts.size() && criterion.smallest_jacobian; ++place)
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
      if (!(smallest_corner<dim>(vertices) >= *criterion.smallest_jacobian))
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
