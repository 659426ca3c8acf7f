// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_point_state.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  template <int dim>
  unsigned int SmoothedPointState<dim>::n_components() const
  {
    unsigned int result = 0;
    for (unsigned int f = 0; f < points.fields().size(); ++f)
      if (f != MaterialPoints::volume && f != MaterialPoints::volume_ratio)
        result += points.fields()[f].n_components;
    return result;
  }

  template <int dim>
  double SmoothedPointState<dim>::get(const unsigned int point, double *values) const
  {
    const double mass = density *
                        points.component(MaterialPoints::volume, 0)[point] /
                        points.component(MaterialPoints::volume_ratio, 0)[point];
    for (unsigned int f = 0; f < points.fields().size(); ++f)
    {
      if (f == MaterialPoints::volume || f == MaterialPoints::volume_ratio)
        continue;
      const bool is_sum = points.fields()[f].name == PlasticHeating::given_name;
      for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
        *values++ = points.component(f, c)[point] / (is_sum ? mass : 1.);
    }
    return mass;
  }

  template <int dim>
  void SmoothedPointState<dim>::set(const unsigned int point, const double *values,
                                           const double mass, const double volume)
  {
    points.component(MaterialPoints::volume, 0)[point] = volume;
    points.component(MaterialPoints::volume_ratio, 0)[point] =
        density * volume / mass;
    for (unsigned int f = 0; f < points.fields().size(); ++f)
    {
      if (f == MaterialPoints::volume || f == MaterialPoints::volume_ratio)
        continue;
      const bool is_sum = points.fields()[f].name == PlasticHeating::given_name;
      for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
        points.component(f, c)[point] = *values++ * (is_sum ? mass : 1.);
    }
  }

  template <int dim>
  void SmoothedPointState<dim>::fill_unused_lanes()
  {
    if (cells.n_cells() == 0)
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
    std::vector<double> of_nodes(n_points * n_lanes);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      rows.interpolate(cells.nodes(batch), temperature, of_nodes.data());
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const unsigned int point = (batch * n_points + q) * n_lanes + lane;
          const double pending = heating.has_plastic_heat()
                                     ? heating.pending(points, point)
                                     : 0.;
          heating.settle(points, point, 0., pending, of_nodes[q * n_lanes + lane]);
        }
    }
  }

  template class SmoothedPointState<2>;
  template class SmoothedPointState<3>;
} // namespace tombolo
