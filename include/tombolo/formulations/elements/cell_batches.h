// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/index_set.h>
#include <deal.II/base/point.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/formulation.h>

#include <vector>

namespace tombolo
{
  /** The number of point @p q of the cell at a slot, where cells have @p n_points points: batch by
   * batch, within a batch point by point, within a point cell by cell. */
  inline unsigned int point_in_lanes(const unsigned int slot, const unsigned int n_points,
                                     const unsigned int q)
  {
    return (slot / n_lanes * n_points + q) * n_lanes + slot % n_lanes;
  }

  /** The node, lexicographic, at a corner of a cell of this degree. */
  template <int dim>
  unsigned int node_of_corner(const unsigned int degree, const unsigned int corner)
  {
    unsigned int node = 0;
    for (unsigned int d = 0, stride = 1; d < dim; ++d, stride *= degree + 1)
      node += ((corner >> d) & 1u) * degree * stride;
    return node;
  }

  /** Lagrange functions of a degree on Gauss-Lobatto points, at a point of [-1, 1]^dim, x first. */
  template <int dim>
  std::vector<double> lagrange_values(unsigned int degree, const dealii::Point<dim> &point);

  enum class MassLumping
  {
    row_sum,      ///< m_I = ∫ ρ φ_I
    gauss_lobatto ///< m_I = ρ times the volume of node I as a Gauss-Lobatto point
  };

  /**
   * The cells of one part that this rank owns, in batches of n_lanes: the nodes of the cells and
   * their lumped masses. Cells keep the order of active cells of the triangulation. The lanes that
   * the last batch has too many repeat its last cell and are not valid.
   *
   * Cells can be removed. Those that remain stay in batches, in their order; a removed cell has a
   * slot behind all batches, for its stored data. Cells can be grouped, too: each group then has
   * batches of its own, with its own lanes that repeat a cell.
   */
  template <int dim>
  class CellBatches
  {
  public:
    /** Sets the cells of the part, with masses of its initial density. Only with @p can_change it
     * stores what remove() and group() need, for @p most_groups. */
    void reinit(const PartSetup<dim> &setup, unsigned int degree, MassLumping lumping,
                bool can_change = false, unsigned int most_groups = 2);

    /** Removes the cells, by their number, that @p is_removed marks from the batches. */
    void remove(const std::vector<bool> &is_removed);

    /** Batches of cells with the same number among group_of_cells, in the order of the numbers. */
    struct Group
    {
      unsigned int number = 1, first_batch = 0, end_batch = 0;
    };

    /** Puts present cells of one number into batches of their own, until cells are removed. */
    void group(const std::vector<unsigned int> &group_of_cells);

    /** One of all batches, until cells are grouped. */
    const std::vector<Group> &groups() const
    {
      return all_groups;
    }

    /** Removed ones included. */
    unsigned int n_cells() const
    {
      return all_cell_count;
    }
    unsigned int n_present_cells() const
    {
      return cell_count;
    }
    /** Of present cells. */
    unsigned int n_batches() const
    {
      return static_cast<unsigned int>(valid_lanes.size());
    }
    /** How many batches there are slots for, those of removed cells included. */
    unsigned int n_batches_of_slots() const
    {
      return padded_to_lanes(all_cell_count) / n_lanes + (can_change ? most_groups - 1 : 0);
    }

    /** The slot of a cell: lane slot % n_lanes of batch slot / n_lanes. */
    unsigned int slot_of(const unsigned int cell) const
    {
      return cell < slots.size() ? slots[cell] : cell;
    }

    /** The number of the cell at a slot in a batch. */
    unsigned int cell_at(const unsigned int slot) const
    {
      return present_cells.empty() ? slot : present_cells[slot];
    }

    /** The nodes of a cell, present or not; only where cells can change. */
    std::vector<dealii::types::global_dof_index> nodes_of_cell(unsigned int cell) const;

    /** The lumped mass of node @p k of a cell [M]. */
    double mass_of_node(const unsigned int cell, const unsigned int k) const
    {
      return cell_mass[std::size_t(cell) * node_count + k];
    }

    /** Those of all cells, by cell and node [M]. */
    const std::vector<double> &masses() const
    {
      return cell_mass;
    }

    /** Sets other lumped masses, by cell and node; only where cells can change [M]. */
    void set_masses(const std::vector<double> &cell_masses);

    unsigned int n_nodes_per_cell() const
    {
      return node_count;
    }

    /** How many lanes of a batch are cells. */
    unsigned int n_valid(const unsigned int batch) const
    {
      return valid_lanes[batch];
    }

    /** Local node numbers of a batch: nodes(b)[n_lanes k + l] is node k of cell l. */
    const unsigned int *nodes(const unsigned int batch) const
    {
      return local_nodes.data() + static_cast<std::size_t>(batch) * node_count * n_lanes;
    }

    /** Initial positions in the order of nodes(): component d of node k of batch b is the n_lanes
     * numbers at ((b n_nodes + k) dim + d) n_lanes. Only until release_initial_positions(). */
    const double *initial_positions(const unsigned int batch) const
    {
      return positions.data() + static_cast<std::size_t>(batch) * node_count * dim * n_lanes;
    }
    void release_initial_positions()
    {
      positions.clear();
      positions.shrink_to_fit();
    }

    const dealii::IndexSet &required_nodes() const
    {
      return node_set;
    }

    void set_partition(const NodePartition &partition);
    void add_mass(NodalVector &mass) const;

    /** Adds (f - 1) m of each present cell and node; @p factors f of all cells. */
    void add_extra_mass(const std::vector<double> &factors, NodalVector &mass) const;

  private:
    void find_local_nodes();
    /** Fills batches with lists of cells, each from a new one on; others get slots behind them. */
    void arrange(const std::vector<std::vector<unsigned int>> &lists);
    void add_mass_of_cell(unsigned int cell);

    unsigned int cell_count = 0; // present
    unsigned int all_cell_count = 0;
    bool can_change = false;
    unsigned int most_groups = 2;
    unsigned int node_count = 0;
    dealii::IndexSet node_set;
    std::vector<double> node_mass;          // in the order of node_set [M]
    std::vector<double> cell_mass;          // of the nodes of all cells [M]
    std::vector<unsigned int> set_to_local; // in the order of node_set
    std::vector<unsigned int> set_nodes;    // as nodes(), numbers within node_set
    std::vector<unsigned int> local_nodes;
    std::vector<double> positions;
    std::vector<unsigned int> valid_lanes; // of each batch
    std::vector<Group> all_groups;

    // Only where cells can change.
    std::vector<unsigned int> nodes_of_cells;       // within node_set, cell by cell
    std::vector<unsigned int> slots, present_cells; // of each cell, of each slot; once needed
  };
} // namespace tombolo
