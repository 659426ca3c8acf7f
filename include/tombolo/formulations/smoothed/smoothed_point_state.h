// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

namespace tombolo
{
  /**
   * The state of the points of a part of smoothed cells for a remap, by components that are values
   * per mass: first the stress, then J and the internal variables, all fields but the volume.
   * Works, which are stored per initial volume, and heat that a point gave, are divided by the mass
   * of the point, so that their sums stay. Refers to the part.
   */
  template <int dim>
  class SmoothedPointState
  {
  public:
    SmoothedPointState(PartPoints &part, const SmoothedGradients<dim> &rows,
                       const PointsInCells<dim> &cell_points);

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

    void get(unsigned int point, double mass, double *values) const;
    void set(unsigned int point, double mass, double volume, const double *values);

    /** Leaves all points without a volume, as those of void cells are. */
    void clear();

    /** Unused lanes repeat the last cell, without a volume. */
    void fill_unused_lanes();

    /** Lets points have the present @p temperature of the nodes (slot 0), raised by the plastic
     * heat that they hold, without expansion. */
    void settle_temperature(const NodalVector &temperature);

  private:
    /** What a field is stored per. */
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
