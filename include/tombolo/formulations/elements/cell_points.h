// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/elements/cell_conversion.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/state/material_points.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /**
   * The cells of a part of elements, and the material points in them.
   *
   * Points are kept batch by batch, within a batch point by point, within a point cell by cell
   * (point_in_lanes()). Where the last batch is not full, its unused lanes repeat the last cell of
   * the part with volume zero, so that sums weighted by volume and extremes need not know of them.
   * The place of a cell is its number, until cells are removed: those that are left close up, and
   * the others keep points of volume zero behind them.
   */
  template <int dim, typename Element>
  class CellPoints
  {
  public:
    static constexpr unsigned int n_nodes = Element::n_nodes;
    static constexpr unsigned int n_points = Element::n_points;
    static constexpr unsigned int points_per_batch = n_points * n_lanes;

    /** A vector, and a number, at each node of a batch. */
    using NodeValues = Lanes[n_nodes][dim];
    using ScalarValues = Lanes[n_nodes];

    /** The number of point @p q of the cell at a place. */
    static unsigned int point_at(const unsigned int place, const unsigned int q)
    {
      return point_in_lanes(place, n_points, q);
    }

    /** The number of the first point of a batch. */
    static std::size_t first_point(const unsigned int batch)
    {
      return std::size_t(batch) * points_per_batch;
    }

    /** Takes the cells of the part, without points. */
    void take_cells(const PartSetup<dim> &setup, bool can_lose_cells);

    /** Makes the points where they are at the start, with @p variables behind the standard fields;
     * their volumes are zero. */
    void create_points(const std::vector<FieldDescription> &variables);

    /** To be called when initial positions are needed no more. */
    void release_initial_node_positions()
    {
      batches.release_initial_positions();
    }

    void set_partition(const NodePartition &partition)
    {
      batches.set_partition(partition);
    }

    /** Takes away the cells, by their number, that @p is_removed names, and brings the points of
     * all cells to their places. */
    void remove(const std::vector<bool> &is_removed);

    const CellBatches<dim> &cells() const
    {
      return batches;
    }
    const MaterialPoints &material_points() const
    {
      return state;
    }
    MaterialPoints &material_points()
    {
      return state;
    }
    const std::vector<dealii::Point<dim>> &initial_positions() const
    {
      return initial_points;
    }

    /** Of node k at point q of a cell, [q][k]. */
    const std::vector<std::vector<double>> &shape_values_at_points() const
    {
      return shape_values;
    }

    /** The shape function of node @p k at point @p q. */
    double shape_value(const unsigned int q, const unsigned int k) const
    {
      return shape_values[q][k];
    }

    /** Positions of the points for given nodal positions. */
    void find_positions(const NodalVector &position,
                        std::vector<dealii::Point<dim>> &positions) const;

    /** The values of a vector at the nodes of a batch. */
    void gather(const unsigned int batch, const NodalVector &vector, NodeValues &values) const
    {
      const unsigned int *const nodes = batches.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        gather_nodes<dim>(vector.data(), nodes + k * n_lanes, values[k]);
    }

    /** Slot 0 of a vector. */
    void gather(const unsigned int batch, const NodalVector &vector, ScalarValues &values) const
    {
      const unsigned int *const nodes = batches.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        values[k] = Lanes([&](const auto lane) { return *vector.node(nodes[k * n_lanes + lane]); });
    }

    /** The initial positions of the nodes of a batch, until they are released. */
    void gather_initial_positions(const unsigned int batch, NodeValues &x) const
    {
      const double *const positions = batches.initial_positions(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          x[k][d] = load_lanes(positions + (k * dim + d) * n_lanes);
    }

    /** Adds @p values at the nodes of the cells of a batch to a vector. */
    void scatter(const unsigned int batch, const NodeValues &values, NodalVector &vector) const
    {
      const unsigned int *const nodes = batches.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        add_to_nodes<dim>(values[k], nodes + k * n_lanes, batches.n_valid(batch), vector.data());
    }

    /** Slot 0 of a vector at the points of a batch. */
    void interpolate(unsigned int batch, const NodalVector &vector, double *at_points) const;

    /** The mean of the nodes of a cell. */
    static dealii::Point<3> centre(const NodeValues &x, const unsigned int lane)
    {
      dealii::Point<3> result;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int k = 0; k < n_nodes; ++k)
          result[d] += x[k][d][lane] / n_nodes;
      return result;
    }

  private:
    CellBatches<dim> batches;
    MaterialPoints state;
    std::vector<dealii::Point<dim>> initial_points;
    std::vector<std::vector<double>> shape_values; // of node k at reference point q
  };

  template <int dim, typename Element>
  void CellPoints<dim, Element>::take_cells(const PartSetup<dim> &setup, const bool can_lose_cells)
  {
    batches.reinit(setup, Element::degree, Element::lumping, can_lose_cells);
    state.reinit(0, {});
  }

  template <int dim, typename Element>
  void CellPoints<dim, Element>::create_points(const std::vector<FieldDescription> &variables)
  {
    state.reinit(batches.n_batches_of_places() * points_per_batch, variables);

    shape_values.clear();
    for (const dealii::Point<dim> &point : Element::reference_points())
      shape_values.push_back(lagrange_values<dim>(Element::degree, point));
    AssertDimension(shape_values.size(), n_points);

    initial_points.assign(state.size(), dealii::Point<dim>());
    for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
    {
      const double *const positions = batches.initial_positions(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double *const values = positions + (k * dim + d) * n_lanes;
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              initial_points[(batch * n_points + q) * n_lanes + lane][d] +=
                  shape_values[q][k] * values[lane];
        }
    }
    for (std::size_t i = first_point(batches.n_batches());
         i < initial_points.size() && batches.n_batches() > 0; ++i)
      initial_points[i] = initial_points[i - points_per_batch]; // as unused lanes
  }

  template <int dim, typename Element>
  void CellPoints<dim, Element>::remove(const std::vector<bool> &is_removed)
  {
    const std::vector<unsigned int> from = remove_cells(is_removed, n_points, batches, state);
    const std::vector<dealii::Point<dim>> old_points = initial_points;
    for (unsigned int place = 0; place < from.size(); ++place)
      for (unsigned int q = 0; q < n_points; ++q)
        initial_points[point_at(place, q)] = old_points[point_at(from[place], q)];
  }

  template <int dim, typename Element>
  void CellPoints<dim, Element>::find_positions(const NodalVector &position,
                                                std::vector<dealii::Point<dim>> &positions) const
  {
    positions.assign(state.size(), dealii::Point<dim>());
    for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const double *const node = position.node(batches.nodes(batch)[k * n_lanes + lane]);
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int d = 0; d < dim; ++d)
              positions[(batch * n_points + q) * n_lanes + lane][d] += shape_values[q][k] * node[d];
        }
  }

  template <int dim, typename Element>
  void CellPoints<dim, Element>::interpolate(const unsigned int batch, const NodalVector &vector,
                                             double *const at_points) const
  {
    ScalarValues values;
    gather(batch, vector, values);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Lanes sum = shape_values[q][0] * values[0];
      for (unsigned int k = 1; k < n_nodes; ++k)
        sum += shape_values[q][k] * values[k];
      store_lanes(sum, at_points + q * n_lanes);
    }
  }
} // namespace tombolo
