// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_overlap.h>

#include <optional>

namespace tombolo
{
  /** Of stresses with components xx, yy, zz, yz, zx, xy. */
  namespace StressInvariants
  {
    constexpr unsigned int n_components = 6;

    /** ½ of the product of the deviators of two stresses. */
    inline double mixed(const double *const a, const double *const b)
    {
      const double mean = (a[0] + a[1] + a[2]) / 3.;
      double sum = 0;
      for (unsigned int c = 0; c < n_components; ++c)
        sum += c < 3 ? 0.5 * (a[c] - mean) * b[c] : a[c] * b[c];
      return sum;
    }

    /** ½ s:s of the deviator of a stress. */
    inline double second(const double *const stress)
    {
      const double mean = (stress[0] + stress[1] + stress[2]) / 3.;
      double sum = 0;
      for (unsigned int c = 0; c < n_components; ++c)
        sum += c < 3 ? 0.5 * (stress[c] - mean) * (stress[c] - mean) : stress[c] * stress[c];
      return sum;
    }
  } // namespace StressInvariants

  /** State at the sub-cells of cells. */
  struct PointValues
  {
    unsigned int n_components = 0;
    std::vector<double> values; ///< by cell, sub-cell and component
    std::vector<double> mass;   ///< by cell and sub-cell [M]
    /** The first of six components that are a stress: it stays within what a convex yield surface
     * allows, if the von Mises stresses around are the largest ones. */
    std::optional<unsigned int> stress;
  };

  /**
   * The conservative remap of the state of points: a sub-cell of after receives the means, weighted
   * by mass, of what it covers of the sub-cells of before, in which the state is linear: a least
   * squares gradient over the cells around, limited so that nothing exceeds the values around. Σ m
   * s stays to round-off for each component, bounds are kept, and linear fields away from extrema
   * are exact at the centres of mass. In the end the sub-cells of a cell have the same density, by
   * an exchange between those with too much and those with too little.
   *
   * The values of cells that have not moved stay but for this exchange. Void cells of after have
   * neither mass nor values. Throws a RunError where a sub-cell has left all cells, and there is
   * none around to receive its mass. Collective.
   */
  template <int dim>
  void remap_points(const CellOverlap<dim> &overlap,
                    const std::shared_ptr<const NodePartition> &partition, PointValues &points);

  /** The values of sub-cells where every cell has one point: linear in each cell, with limited
   * slopes, so that the means of remap_points() over cells conserve, keep bounds and are of second
   * order as well. @p cell_values has one value a cell; RemapCell::mass are the masses of the
   * sub-cells. Collective. */
  template <int dim>
  PointValues values_of_sub_cells(const std::vector<RemapCell<dim>> &cells,
                                  const std::shared_ptr<const NodePartition> &partition,
                                  const PointValues &cell_values);

  /** Sets the means and the masses of cells that have moved from those of their sub-cells. */
  template <int dim>
  void set_means_of_cells(const std::vector<RemapCell<dim>> &cells,
                          const PointValues &sub_cell_values, PointValues &cell_values);
} // namespace tombolo
