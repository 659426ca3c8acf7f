// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// The members of CellFormulation that have to do with inertia and the step that it allows; included
// at its end.
#include <tombolo/formulations/elements/cell_formulation.h>

namespace tombolo
{
  template <int dim, typename Element>
  void CellFormulation<dim, Element>::find_volumes(const unsigned int batch,
                                                   const NodalVector &position, NodeValues &x,
                                                   Lanes (&volume)[n_points]) const
  {
    NodeValues v;
    gather(batch, position, x);
    for (unsigned int k = 0; k < n_nodes; ++k)
      for (unsigned int d = 0; d < dim; ++d)
        v[k][d] = 0.;
    typename Element::Work work;
    Matrix3<Lanes> gradient[n_points];
    element.evaluate(x, v, work, volume, gradient);
  }

  template <int dim, typename Element>
  template <typename Use>
  void CellFormulation<dim, Element>::for_crossing_times(const NodalVector &position,
                                                         const Use &use) const
  {
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      NodeValues x;
      Lanes volume[n_points];
      find_volumes(batch, position, x, volume);

      // The moduli are constant, the density is not: c grows with √J.
      const double *const volume_ratio =
          material_points.component(MaterialPoints::volume_ratio, 0) +
          std::size_t(batch) * points_per_batch;
      Lanes total = 0., largest_ratio = 0.;
      for (unsigned int q = 0; q < n_points; ++q)
      {
        total += volume[q];
        largest_ratio = max(largest_ratio, load_lanes(volume_ratio + q * n_lanes));
      }
      const Lanes time = characteristic_length<dim, Element::degree>(x, total) /
                         (part_material->longitudinal_wave_speed() * square_root(largest_ratio));
      use(batch, x, time);
    }
  }

  template <int dim, typename Element>
  StepLimit CellFormulation<dim, Element>::courant_limit(const NodalVector &position) const
  {
    StepLimit limit;
    limit.entity = "cell";
    for_crossing_times(position,
                       [&](const unsigned int batch, const NodeValues &x, const Lanes &time)
                       {
                         for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
                         {
                           const double factor =
                               inertia_factors.empty()
                                   ? 1.
                                   : inertia_factors[cells.cell_at(batch * n_lanes + lane)];
                           const double step = time[lane] * std::sqrt(factor);
                           if (step < limit.time_step)
                           {
                             limit.time_step = step;
                             limit.place = centre(x, lane);
                           }
                         }
                       });
    return limit;
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::courant_limits(const NodalVector &position,
                                                     std::vector<double> &time_steps) const
  {
    constexpr double of_removed_cells = 1e300;
    time_steps.assign(cells.n_cells(), of_removed_cells);
    for_crossing_times(position,
                       [&](const unsigned int batch, const NodeValues &, const Lanes &time)
                       {
                         for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
                           time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
                       });
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::scale_inertia(const std::vector<double> &factors)
  {
    AssertDimension(factors.size(), cells.n_cells());
    inertia_factors = factors;
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_extra_mass(NodalVector &mass) const
  {
    if (!inertia_factors.empty())
      cells.add_extra_mass(inertia_factors, mass);
  }
} // namespace tombolo
