// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /**
   * The state of the points of a part of smoothed cells for a remap, by components that are values
   * per mass: first the stress, then J and the internal variables, all fields but the volume.
   * What is held when cells are divided, energies per initial volume, and what belongs to the whole
   * point then, heat that it gave, are divided by the mass of the point, so that their sums stay.
   * Refers to the part.
   */
  template <int dim>
  class SmoothedPointState
  {
  public:
    SmoothedPointState(PartPoints &part, const SmoothedGradients<dim> &rows,
                       const PointsInCells<dim> &cell_points)
        : points(part.points()), density(part.material().density()), heating(part.heating()),
          rows(rows), cell_points(cell_points)
    {
      for (unsigned int f = 0; f < points.fields().size(); ++f)
      {
        const FieldDescription &field = points.fields()[f];
        const Measure measure = field.on_division == OnDivision::held     ? Measure::initial_volume
                                : field.on_division == OnDivision::shared ? Measure::point
                                                                          : Measure::none;
        for (unsigned int c = 0; c < field.n_components && f != MaterialPoints::volume; ++c)
          components.push_back({points.component(f, c), measure});
      }
    }

    unsigned int n_components() const
    {
      return static_cast<unsigned int>(components.size());
    }

    /** Has where points are in their cells. */
    const SmoothedGradients<dim> &gradients() const
    {
      return rows;
    }

    /** The component that is J, after those of the stress. */
    static constexpr unsigned int volume_ratio = 6;

    /** That of the initial density and J [M]. */
    double mass(const unsigned int point) const
    {
      return density * initial_volume(point);
    }

    void get(const unsigned int point, const double mass, double *values) const
    {
      for (const Component &component : components)
        *values++ = component.values[point] * (component.measure == Measure::initial_volume
                                                   ? initial_volume(point) / mass
                                               : component.measure == Measure::point ? 1. / mass
                                                                                     : 1.);
    }
    void set(const unsigned int point, const double mass, const double volume,
             const double *const values)
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

    /** Leaves all points without a volume, as those of void cells are. */
    void clear()
    {
      const unsigned int n = points.padded_size();
      for (const Component &component : components)
        std::fill_n(component.values, n, 0.);
      std::fill_n(points.component(MaterialPoints::volume, 0), n, 0.);
      std::fill_n(points.component(MaterialPoints::volume_ratio, 0), n, 1.);
    }

    /** Unused lanes repeat the last cell, without a volume. */
    void fill_unused_lanes()
    {
      for (unsigned int f = 0; f < points.fields().size(); ++f)
        if (f != MaterialPoints::volume)
          cell_points.fill_unused_lanes(points, f);
    }

    /** Sets the temperature of points to the present @p temperature of the nodes (slot 0), raised
     * by the plastic heat that they hold, without expansion. */
    void set_point_temperature(const NodalVector &temperature)
    {
      if (!heating.is_on())
        return;
      const unsigned int n_points = rows.n_points_per_cell();
      const CellBatches<dim> &cells = cell_points.cells();
      std::vector<double> nodal_temperatures(n_points * n_lanes);
      for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
      {
        cell_points.interpolate(batch, temperature, nodal_temperatures.data());
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
          {
            const unsigned int point = (batch * n_points + q) * n_lanes + lane;
            const double pending = heating.has_plastic_heat() ? heating.pending(points, point) : 0.;
            heating.set_pending_heat(points, point, 0., pending,
                                     nodal_temperatures[q * n_lanes + lane]);
          }
      }
    }

  private:
    /** The measure that a field is stored per. */
    enum class Measure
    {
      none,
      initial_volume,
      point
    };
    struct Component
    {
      double *values;
      Measure measure;
    };

    double initial_volume(const unsigned int point) const
    {
      return points.component(MaterialPoints::volume, 0)[point] /
             points.component(MaterialPoints::volume_ratio, 0)[point];
    }

    MaterialPoints &points;
    std::vector<Component> components;
    double density; // initial [M/L^dim]
    const PlasticHeating &heating;
    const SmoothedGradients<dim> &rows;
    const PointsInCells<dim> &cell_points;
  };
} // namespace tombolo
