// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_batches.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/part_points.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** Slot 0 of a vector at the points of n_lanes cells with these local @p nodes
   * (CellBatches::nodes()), by the shape functions of node k at point q, [q][k]. */
  inline void interpolate_at_points(const unsigned int *const nodes,
                                    const std::vector<std::vector<double>> &shape_values,
                                    const NodalVector &vector, double *const at_points)
  {
    std::fill_n(at_points, shape_values.size() * n_lanes, 0.);
    for (std::size_t k = 0; k < shape_values.front().size(); ++k)
    {
      const Lanes value([&](const auto lane) { return *vector.node(nodes[k * n_lanes + lane]); });
      for (std::size_t q = 0; q < shape_values.size(); ++q)
        store_lanes(load_lanes(at_points + q * n_lanes) + shape_values[q][k] * value,
                    at_points + q * n_lanes);
    }
  }

  /**
   * The cells of a part, and where its material points are in them.
   *
   * Points are kept batch by batch, within a batch point by point, within a point cell by cell
   * (point_in_lanes()). Where the last batch is not full, its unused lanes repeat the last cell of
   * the part with volume zero, so that sums weighted by volume and extremes need not exclude them.
   * The slot of a cell is its number, until cells are removed: the remaining cells then close up,
   * and the removed ones keep points of volume zero behind them.
   */
  template <int dim>
  class PointsInCells
  {
  public:
    /** Sets the cells of the part, as CellBatches::reinit(), without points. */
    void set_cells(const PartSetup<dim> &setup, const unsigned int degree,
                   const MassLumping lumping, const bool can_change,
                   const unsigned int most_groups = 2)
    {
      batches.reinit(setup, degree, lumping, can_change, most_groups);
      initial_points.clear();
      shape_values.clear();
    }

    /** Creates points of cells in @p n_batches by shape functions [q][k], initial positions. */
    void create_points(const std::vector<std::vector<double>> &values, const unsigned int n_batches)
    {
      shape_values = values;
      const unsigned int n_points = n_points_per_cell(), per_batch = n_points * n_lanes;
      initial_points.assign(std::size_t(n_batches) * per_batch, dealii::Point<dim>());
      for (unsigned int slot = 0; slot < batches.n_batches() * n_lanes; ++slot)
      {
        const double *const x = batches.initial_positions(slot / n_lanes) + slot % n_lanes;
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int k = 0; k < shape_values[q].size(); ++k)
            for (unsigned int d = 0; d < dim; ++d)
              initial_points[point_of_slot(slot, q)][d] +=
                  shape_values[q][k] * x[(k * dim + d) * n_lanes];
      }
      for (std::size_t i = std::size_t(batches.n_batches()) * per_batch;
           i < initial_points.size() && batches.n_batches() > 0; ++i)
        initial_points[i] = initial_points[i - per_batch]; // as unused lanes
    }

    /** Removes the marked cells. @p points, where they exist, go with their cells: those of unused
     * lanes repeat the last cell, and these and those of removed cells have no volume. */
    void remove(const std::vector<bool> &is_removed, MaterialPoints &points)
    {
      rearrange(points, [&] { batches.remove(is_removed); });
    }

    /** CellBatches::group(); @p points go with their cells. */
    void group(const std::vector<unsigned int> &group_of_cells, MaterialPoints &points)
    {
      rearrange(points, [&] { batches.group(group_of_cells); });
    }

    /** Lanes that are not valid repeat a cell in a field of @p points. */
    void fill_unused_lanes(MaterialPoints &points, const unsigned int field) const
    {
      for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
        for (unsigned int q = 0; q < n_points_per_cell(); ++q)
          for (unsigned int c = 0; c < points.fields()[field].n_components; ++c)
          {
            double *const lanes = points.component(field, c) + point_of_slot(batch * n_lanes, q);
            const unsigned int n = batches.n_valid(batch);
            std::fill(lanes + n, lanes + n_lanes, lanes[n - 1]);
          }
    }

    const CellBatches<dim> &cells() const
    {
      return batches;
    }
    CellBatches<dim> &cells()
    {
      return batches;
    }

    /** Of all slots; zero without points. */
    unsigned int n_points_of_slots() const
    {
      return static_cast<unsigned int>(initial_points.size());
    }
    unsigned int n_points_per_cell() const
    {
      return static_cast<unsigned int>(shape_values.size());
    }

    unsigned int point_of_slot(const unsigned int slot, const unsigned int q) const
    {
      return point_in_lanes(slot, n_points_per_cell(), q);
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

    void find_positions(const NodalVector &position,
                        std::vector<dealii::Point<dim>> &positions) const
    {
      positions.assign(initial_points.size(), dealii::Point<dim>());
      for (unsigned int slot = 0; slot < batches.n_batches() * n_lanes; ++slot)
        for (unsigned int k = 0; k < batches.n_nodes_per_cell(); ++k)
        {
          const double *const node =
              position.node(batches.nodes(slot / n_lanes)[k * n_lanes + slot % n_lanes]);
          for (unsigned int q = 0; q < n_points_per_cell(); ++q)
            for (unsigned int d = 0; d < dim; ++d)
              positions[point_of_slot(slot, q)][d] += shape_values[q][k] * node[d];
        }
    }

    /** Slot 0 of a vector at the points of a batch. */
    void interpolate(const unsigned int batch, const NodalVector &vector, double *at_points) const
    {
      interpolate_at_points(batches.nodes(batch), shape_values, vector, at_points);
    }

    /** Adds plastic heat of @p points to the nodes; @p cell_heat, unless null, is that by cell. */
    void add_plastic_heat(PartPoints &points, NodalVector &heat,
                          std::vector<double> *const cell_heat = nullptr) const
    {
      if (cell_heat != nullptr)
        cell_heat->assign(batches.n_cells(), 0.);
      if (!points.heating().has_plastic_heat())
        return;
      for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
        for (unsigned int q = 0; q < n_points_per_cell(); ++q)
          for (unsigned int lane = 0; lane < batches.n_valid(batch); ++lane)
          {
            const unsigned int slot = batch * n_lanes + lane;
            const double point_heat =
                points.heating().give(points.points(), point_of_slot(slot, q));
            if (cell_heat != nullptr)
              (*cell_heat)[batches.cell_at(slot)] += point_heat;
            for (unsigned int k = 0; k < shape_values[q].size(); ++k)
              *heat.node(batches.nodes(batch)[k * n_lanes + lane]) +=
                  shape_values[q][k] * point_heat;
          }
    }

  protected:
    CellBatches<dim> batches;

  private:
    /** Changes the batches, and moves the points to the new slots of their cells. */
    template <typename Change>
    void rearrange(MaterialPoints &points, const Change &change)
    {
      const unsigned int n_points = n_points_per_cell();
      const unsigned int n_slots = batches.n_batches_of_slots() * n_lanes;
      std::vector<unsigned int> from(n_slots, 0), old_slot(batches.n_cells());
      for (unsigned int cell = 0; cell < batches.n_cells(); ++cell)
        old_slot[cell] = batches.slot_of(cell);
      change();
      for (unsigned int cell = 0; cell < batches.n_cells(); ++cell)
        from[batches.slot_of(cell)] = old_slot[cell];
      std::vector<bool> is_cell(n_slots, false);
      for (unsigned int batch = 0; batch < batches.n_batches(); ++batch)
        for (unsigned int lane = 0, last = 0; lane < n_lanes; ++lane)
        {
          const unsigned int slot = batch * n_lanes + lane;
          is_cell[slot] = lane < batches.n_valid(batch);
          if (is_cell[slot])
            last = slot;
          else
            from[slot] = from[last];
        }

      const auto move = [&](auto *const values, const auto &old)
      {
        for (unsigned int slot = 0; slot < n_slots; ++slot)
          for (unsigned int q = 0; q < n_points; ++q)
            values[point_of_slot(slot, q)] = old[point_of_slot(from[slot], q)];
      };
      move(initial_points.data(), std::vector<dealii::Point<dim>>(initial_points));
      if (points.size() == 0) // they are not made yet
        return;
      for (unsigned int f = 0; f < points.fields().size(); ++f)
        for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
        {
          double *const values = points.component(f, c);
          move(values, std::vector<double>(values, values + points.size()));
        }
      for (unsigned int slot = 0; slot < n_slots; ++slot)
        for (unsigned int q = 0; q < n_points && !is_cell[slot]; ++q)
        {
          points.component(MaterialPoints::volume, 0)[point_of_slot(slot, q)] = 0.;
          points.component(MaterialPoints::volume_ratio, 0)[point_of_slot(slot, q)] = 1.;
        }
    }

    std::vector<dealii::Point<dim>> initial_points;
    std::vector<std::vector<double>> shape_values;
  };

  /** The same for one element type, with the values at the nodes of a batch. */
  template <int dim, typename Element>
  class CellPoints : public PointsInCells<dim>
  {
  public:
    static constexpr unsigned int n_nodes = Element::n_nodes;
    static constexpr unsigned int n_points = Element::n_points;
    static constexpr unsigned int points_per_batch = n_points * n_lanes;

    /** A vector, and a number, at each node of a batch. */
    using NodeValues = Lanes[n_nodes][dim];
    using ScalarValues = Lanes[n_nodes];

    static unsigned int point_at(const unsigned int slot, const unsigned int q)
    {
      return point_in_lanes(slot, n_points, q);
    }

    static std::size_t first_point(const unsigned int batch)
    {
      return std::size_t(batch) * points_per_batch;
    }

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

    void scatter(const unsigned int batch, const NodeValues &values, NodalVector &vector) const
    {
      const unsigned int *const nodes = batches.nodes(batch);
      for (unsigned int k = 0; k < n_nodes; ++k)
        add_to_nodes<dim>(values[k], nodes + k * n_lanes, batches.n_valid(batch), vector.data());
    }

  private:
    using PointsInCells<dim>::batches;
  };
} // namespace tombolo
