// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_point_state.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  template <int dim>
  SmoothedPointState<dim>::SmoothedPointState(PartPoints &part, const SmoothedGradients<dim> &rows,
                                              const PointsInCells<dim> &cell_points)
      : points(part.points()), density(part.material().density()), heating(part.heating()),
        rows(rows), cell_points(cell_points)
  {
    for (unsigned int f = 0; f < points.fields().size(); ++f)
    {
      const FieldDescription &field = points.fields()[f];
      const bool is_work =
          field.name.size() >= 4 && field.name.compare(field.name.size() - 4, 4, "work") == 0;
      for (unsigned int c = 0; c < field.n_components && f != MaterialPoints::volume; ++c)
        components.push_back({points.component(f, c), is_work ? Measure::initial_volume
                                                      : field.name == PlasticHeating::given_name
                                                          ? Measure::point
                                                          : Measure::none});
    }
  }

  template <int dim>
  void SmoothedPointState<dim>::get(const unsigned int point, const double mass,
                                    double *values) const
  {
    for (const Component &component : components)
      *values++ = component.values[point] * (component.measure == Measure::initial_volume
                                                 ? initial_volume(point) / mass
                                             : component.measure == Measure::point ? 1. / mass
                                                                                   : 1.);
  }

  template <int dim>
  void SmoothedPointState<dim>::set(const unsigned int point, const double mass,
                                    const double volume, const double *const values)
  {
    points.component(MaterialPoints::volume, 0)[point] = volume;
    const double *value = values;
    for (const Component &component : components)
      component.values[point] = *value++;
    for (const Component &component : components)
      if (component.measure != Measure::none)
        component.values[point] *=
            component.measure == Measure::point ? mass : mass / initial_volume(point);
  }

  template <int dim>
  void SmoothedPointState<dim>::clear()
  {
    const unsigned int n = points.padded_size();
    for (const Component &component : components)
      std::fill_n(component.values, n, 0.);
    std::fill_n(points.component(MaterialPoints::volume, 0), n, 0.);
    std::fill_n(points.component(MaterialPoints::volume_ratio, 0), n, 1.);
  }

  template <int dim>
  void SmoothedPointState<dim>::fill_unused_lanes()
  {
    const CellBatches<dim> &cells = cell_points.cells();
    if (cells.n_batches() == 0)
      return;
    const unsigned int n_points = rows.n_points_per_cell();
    const unsigned int batch = cells.n_batches() - 1, last = cells.n_valid(batch) - 1;
    for (unsigned int f = 0; f < points.fields().size(); ++f)
      for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
        for (unsigned int q = 0; q < n_points && f != MaterialPoints::volume; ++q)
        {
          double *const lanes =
              points.component(f, c) + std::size_t(batch * n_points + q) * n_lanes;
          std::fill(lanes + last + 1, lanes + n_lanes, lanes[last]);
        }
  }

  template <int dim>
  void SmoothedPointState<dim>::settle_temperature(const NodalVector &temperature)
  {
    if (!heating.is_on())
      return;
    const unsigned int n_points = rows.n_points_per_cell();
    const CellBatches<dim> &cells = cell_points.cells();
    std::vector<double> of_nodes(n_points * n_lanes);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      cell_points.interpolate(batch, temperature, of_nodes.data());
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const unsigned int point = (batch * n_points + q) * n_lanes + lane;
          const double pending = heating.has_plastic_heat() ? heating.pending(points, point) : 0.;
          heating.settle(points, point, 0., pending, of_nodes[q * n_lanes + lane]);
        }
    }
  }

  template class SmoothedPointState<2>;
  template class SmoothedPointState<3>;
} // namespace tombolo
