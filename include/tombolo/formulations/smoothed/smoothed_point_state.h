// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/plastic_heating.h>
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

namespace tombolo
{
  /** The state of the points of a part of smoothed cells for a remap: all fields but volumes, first
   * the stress, then the internal variables, those that are sums over the point divided by its
   * mass. Refers to the part. */
  template <int dim>
  class SmoothedPointState
  {
  public:
    SmoothedPointState(MaterialPoints &points, double density, const PlasticHeating &heating,
                       const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells)
        : points(points), density(density), heating(heating), rows(rows), cells(cells)
    {}

    unsigned int n_components() const;

    /** Returns the mass of the point [M]. */
    double get(unsigned int point, double *values) const;

    /** Gives a point a state, a mass and a volume; J follows. */
    void set(unsigned int point, const double *values, double mass, double volume);

    /** Unused lanes repeat the last cell, without a volume. */
    void fill_unused_lanes();

    /** Lets points have the present @p temperature of the nodes (slot 0), raised by the plastic
     * heat that they hold, without expansion. */
    void settle_temperature(const NodalVector &temperature);

  private:
    MaterialPoints &points;
    double density; // initial [M/L^dim]
    const PlasticHeating &heating;
    const SmoothedGradients<dim> &rows;
    const CellBatches<dim> &cells;
  };
} // namespace tombolo
