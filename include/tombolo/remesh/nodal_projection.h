// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/ordered_sum.h>
#include <tombolo/remesh/cell_matrices.h>
#include <tombolo/remesh/cell_overlap.h>
#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace tombolo
{
  /** The largest of the values of the cells of all ranks at each node. First raise(), then share(),
   * then the rest. */
  class NodeMaxima
  {
  public:
    /** Nodes without a value have @p nothing. */
    explicit NodeMaxima(const std::shared_ptr<const NodePartition> &partition,
                        const double nothing = -1e300)
        : maxima(std::make_unique<Vector>(partition->scalars()))
    {
      for (unsigned int i = 0; i < partition->n_owned() + partition->n_ghosts(); ++i)
        maxima->local_element(i) = nothing;
    }

    void raise(const unsigned int node, const double value)
    {
      double &node_maximum = maxima->local_element(node);
      node_maximum = std::max(node_maximum, value);
    }

    /** Collective. */
    void share()
    {
      maxima->compress(dealii::VectorOperation::max);
      maxima->update_ghost_values();
    }

    /** Of an owned or ghost node. */
    double operator[](const unsigned int node) const
    {
      return maxima->local_element(node);
    }

    template <typename Nodes>
    double largest_of(const Nodes &nodes) const
    {
      double result = (*this)[nodes[0]];
      for (const unsigned int node : nodes)
        result = std::max(result, (*this)[node]);
      return result;
    }

  private:
    using Vector = dealii::LinearAlgebra::distributed::Vector<double>;
    std::unique_ptr<Vector> maxima; // a Vector that is copied or moved loses its ghosts
  };

  template <int dim>
  std::vector<bool> moved_nodes(const CellOverlap<dim> &overlap, const unsigned int n_owned)
  {
    constexpr double smallest_way = 1e-9; // of a cell: less is round-off
    std::vector<bool> result(n_owned, false);
    for (const RemapCell<dim> &cell : overlap.cells)
    {
      const double way = smallest_way * (cell.before.back() - cell.before.front()).norm();
      for (unsigned int k = 0; k < cell.nodes.size(); ++k)
        if (cell.nodes[k] < n_owned && (cell.after[k] - cell.before[k]).norm() > way)
          result[cell.nodes[k]] = true;
    }
    return result;
  }

  /** Adds the integrals of field @p number over all cells, and the masses ∫ ρ Ψ⁺. Collective. */
  template <int dim>
  void add_integrals(const CellOverlap<dim> &overlap, const unsigned int number,
                     CellMatrices<dim> &matrices, NodalVector &right_side, NodalVector &after)
  {
    constexpr unsigned int n_corners = CellOverlap<dim>::n_corners;
    const auto add_cell = [&](const std::size_t c)
    {
      const auto &integrals = overlap.integrals[c];
      const auto &nodes = overlap.cells[c].nodes;
      matrices.add_cell(nodes, integrals.matrix);
      for (unsigned int k = 0; k < n_corners; ++k)
      {
        *after.node(nodes[k]) += integrals.mass[k];
        for (unsigned int slot = 0; slot < node_stride; ++slot)
          right_side.node(nodes[k])[slot] +=
              integrals.values[(std::size_t(number) * n_corners + k) * node_stride + slot];
      }
    };
    add_up({&right_side, &after},
           [&]
           {
             for (std::size_t c = 0; c < overlap.cells.size(); ++c)
               add_cell(c);
           });
  }

  /** The largest of @p sign times a slot of a field at nodes up to two cells away that have
   * material before. */
  template <int dim>
  NodeMaxima largest_around(const std::vector<RemapCell<dim>> &cells, const NodalVector &field,
                            const unsigned int slot, const double sign)
  {
    constexpr unsigned int n_rings = 2;
    NodeMaxima result(field.partition());
    for (const RemapCell<dim> &cell : cells)
      for (unsigned int k = 0; k < cell.nodes.size() && !cell.is_void_before; ++k)
        result.raise(cell.nodes[k], sign * field.node(cell.nodes[k])[slot]);
    result.share();
    for (unsigned int ring = 0; ring < n_rings; ++ring)
    {
      NodeMaxima next(field.partition());
      for (const RemapCell<dim> &cell : cells)
      {
        const double cell_maximum = result.largest_of(cell.nodes);
        for (const unsigned int node : cell.nodes)
          next.raise(node, cell_maximum);
      }
      next.share();
      result = std::move(next);
    }
    return result;
  }

  /**
   * The conservative remap of a nodal field: the weighted least squares
   *
   * @verbatim
   *   Σ_K (∫ ρ Ψ⁺_J Ψ⁺_K + δ_JK d_J) z⁺_K = ∫ ρ Ψ⁺_J z⁻ + d_J z⁻_J
   * @endverbatim
   *
   * in the present body, with the functions of CellSimplices and the exact integrals of
   * CellOverlap. d_J is what node J has of @p mass_after beyond the integrals, and never less than
   * zero: the mass of other parts there, and what the lumped masses of cells that stay have. At
   * nodes that have moved, d is multiplied by the mean of the field around them. One shift of all
   * nodes keeps Σ m z. Linear fields stay where d is zero or nodes stay, constant ones everywhere.
   * Nodes that have lost all cells have zero.
   *
   * @p field number @p number of the overlap, node_stride slots; @p mass and @p mass_after: scalar,
   * in the measure of ρ, at owned nodes. @p field receives the values of after, with current
   * ghosts. Collective.
   */
  template <int dim>
  void project_nodal_field(const CellOverlap<dim> &overlap, const unsigned int number,
                           const NodalVector &mass, const NodalVector &mass_after,
                           NodalVector &field)
  {
    if (!overlap.has_motion)
      return;
    const auto &partition = field.partition();
    const unsigned int n_owned = partition->n_owned();
    CellMatrices<dim> matrices(partition, overlap.cells.size());
    NodalVector right_side(partition, field.quantity()), after(partition, Quantity::scalar);
    add_integrals(overlap, number, matrices, right_side, after);
    // Of the lumped matrix; zero at nodes of other parts.
    NodalVector weight(partition, Quantity::scalar);
    const auto new_mass = [&](const unsigned int i)
    { return *weight.node(i) > 0. ? *mass_after.node(i) : 0.; };
    std::vector<double> sums(2 * node_stride + 1, 0.);
    const std::vector<bool> has_moved = moved_nodes(overlap, n_owned);
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      if (!(*after.node(i) > 0.))
      {
        // The content of a node that has lost all of its cells is distributed to the others.
        if (!(*mass.node(i) > 0.) || *mass_after.node(i) > 0.)
          continue;
        for (unsigned int slot = 0; slot < node_stride; ++slot)
        {
          sums[slot] += *mass.node(i) * field.node(i)[slot];
          field.node(i)[slot] = 0.;
        }
        continue;
      }
      // Less than nothing on the diagonal would let modes grow that alternate between nodes.
      const double rest = std::max(0., *mass_after.node(i) - *after.node(i));
      *matrices.diagonal.node(i) = rest;
      *weight.node(i) = *after.node(i) + rest;
      for (unsigned int slot = 0; slot < node_stride; ++slot)
      {
        double &value = right_side.node(i)[slot];
        sums[slot] += *mass.node(i) * field.node(i)[slot];
        value += has_moved[i] || *mass.node(i) == 0. ? rest * value / *after.node(i)
                                                     : rest * field.node(i)[slot];
      }
    }
    constexpr double tolerance = 1e-15;
    matrices.solve(right_side, weight, tolerance, field);
    // Restores the sums, which the iterations and masses that shrink have changed.
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      sums[2 * node_stride] += new_mass(i);
      for (unsigned int slot = 0; slot < node_stride; ++slot)
        sums[node_stride + slot] += new_mass(i) * field.node(i)[slot];
    }
    sums = ordered_sum(sums, overlap.communicator);
    field.fill(
        [&](const unsigned int i, double *const value)
        {
          for (unsigned int slot = 0; slot<node_stride && * weight.node(i)> 0.; ++slot)
            value[slot] += (sums[slot] - sums[node_stride + slot]) / sums[2 * node_stride];
        });
  }

  /**
   * Keeps a field of project_nodal_field() between the values that it had @p before, with ghosts,
   * at nodes up to two cells away: a projection overshoots beside steep gradients. What this adds
   * or removes is distributed where there is room for it around cells that have moved, so that Σ m
   * z stays. @p mass: m⁺, at owned nodes. Collective.
   */
  template <int dim>
  void limit_nodal_field(const CellOverlap<dim> &overlap, const NodalVector &before,
                         const NodalVector &mass, NodalVector &field)
  {
    if (!overlap.has_motion)
      return;
    const unsigned int n_owned = field.partition()->n_owned();
    const NodalVector is_near =
        marked_nodes(field.partition(),
                     [&](const auto &mark)
                     {
                       for (const RemapCell<dim> &cell : overlap.cells)
                         if (cell.has_moved())
                           std::for_each(cell.nodes.begin(), cell.nodes.end(), mark);
                     });
    for (unsigned int slot = 0; slot < node_stride; ++slot)
    {
      const auto highest = largest_around<dim>(overlap.cells, before, slot, 1.);
      const auto lowest = largest_around<dim>(overlap.cells, before, slot, -1.);
      std::array<double, 3> sums{}; // what was cut off, room below and above
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        if (!(*is_near.node(i) > 0.))
          continue;
        double &value = field.node(i)[slot];
        const double low = -lowest[i], high = highest[i];
        if (low > high)
          continue; // there was no material around
        const double limited = std::min(std::max(value, low), high);
        sums[0] += *mass.node(i) * (value - limited);
        sums[1] += *mass.node(i) * (limited - low);
        sums[2] += *mass.node(i) * (high - limited);
        value = limited;
      }
      sums = ordered_sum(sums, overlap.communicator);
      const double room = sums[0] > 0. ? sums[2] : sums[1];
      for (unsigned int i = 0; i < n_owned && room > 0.; ++i)
        if (*is_near.node(i) > 0. && -lowest[i] <= highest[i])
        {
          double &value = field.node(i)[slot];
          const double bound = sums[0] > 0. ? highest[i] : -lowest[i];
          value += std::abs(sums[0]) / room * (bound - value);
        }
    }
    field.update_ghosts();
  }

  /** ∫ ρ Ψ⁺ of each corner of a cell of after whose sub-cells have these masses [M]. */
  template <int dim>
  std::array<double, SubCells<dim>::n_corners>
  masses_of_corners(const typename SubCells<dim>::Corners &corners,
                    const double *const sub_cell_masses)
  {
    const SimplexPoints<dim> &points = SimplexPoints<dim>::instance();
    double simplex_volumes[SimplexLanes<dim>::n_padded];
    SimplexLanes<dim>(corners).find_volumes(simplex_volumes);
    std::array<double, SubCells<dim>::n_sub_cells> volumes{};
    for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
    {
      // Simplices that are turned over, as there can be next to void cells, have nothing.
      simplex_volumes[s] = std::max(0., simplex_volumes[s]);
      volumes[points.sub_cell[s]] += simplex_volumes[s];
    }
    std::array<double, SubCells<dim>::n_corners> result{};
    for (unsigned int s = 0; s < SimplexPoints<dim>::n_simplices; ++s)
    {
      const unsigned int sub_cell = points.sub_cell[s];
      const double mass = sub_cell_masses[sub_cell] / volumes[sub_cell] * simplex_volumes[s];
      for (unsigned int k = 0; k < result.size(); ++k)
        result[k] += mass * points.simplex_shares[s][k] / (dim + 1);
    }
    return result;
  }
} // namespace tombolo
