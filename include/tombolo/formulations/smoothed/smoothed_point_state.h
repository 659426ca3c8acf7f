// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/plastic_heating.h>
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
    SmoothedPointState(MaterialPoints &points, double density, const PlasticHeating &heating,
                       const SmoothedGradients<dim> &rows, const CellBatches<dim> &cells);

    unsigned int n_components() const;

    /** Has where points are in their cells. */
    const SmoothedGradients<dim> &gradients() const
    {
      return rows;
    }

    /** The component that is J. */
    unsigned int volume_ratio() const;

    /** That of the initial density and J [M]. */
    double mass(unsigned int point) const;

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

    double initial_volume(unsigned int point) const;

    MaterialPoints &points;
    std::vector<Component> components;
    double density; // initial [M/L^dim]
    const PlasticHeating &heating;
    const SmoothedGradients<dim> &rows;
    const CellBatches<dim> &cells;
  };

  /** The initial positions of the points of cells, in batches, with the @p shares of the corners of
   * a cell in each of its points, [q][k]. While the cells know their initial positions. */
  template <int dim>
  std::vector<dealii::Point<dim>> initial_points_of(const CellBatches<dim> &cells,
                                                    const std::vector<std::vector<double>> &shares);
} // namespace tombolo
