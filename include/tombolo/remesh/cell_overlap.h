// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_simplices.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <map>
#include <memory>
#include <vector>

namespace tombolo
{
  template <int dim>
  struct ReceivedCell;

  /** A cell whose corners move, while the material stays where it is. */
  template <int dim>
  struct RemapCell
  {
    std::array<unsigned int, SubCells<dim>::n_corners> nodes; ///< local numbers
    typename SubCells<dim>::Corners before, after;
    /** Masses of the sub-cells before [M]. */
    std::array<double, SubCells<dim>::n_sub_cells> mass{};
    /** Whether the surface of the body has moved at one of its corners, so that cells of after need
     * not cover all of it. */
    bool is_cut = false;
    double body = 0; ///< its number (Bodies); for interpolation, which does not use the mesh
    /** Whether it has no material before, and is to have none after. */
    bool is_void_before = false, is_void_after = false;

    /** Whether it changes: at another position, filled or emptied. Void cells that stay void do not
     * count. */
    bool has_moved() const
    {
      if (is_void_before || is_void_after)
        return is_void_before != is_void_after;
      for (unsigned int k = 0; k < before.size(); ++k)
        if (before[k] != after[k])
          return true;
      return false;
    }
  };

  /**
   * The overlap of the cells of a part before and after their corners have moved, exactly: every
   * simplex of before is cut by those of after. The mass of a sub-cell of before is uniform in what
   * cells of after cover of it; that of one that they do not cover at all is distributed to those
   * around (distribute_to_neighbours()). Contains the integrals of the conservative projection of
   * nodal fields, and the share of each sub-cell of before in each sub-cell of after. Cells of
   * before are sent to the ranks whose cells they reach.
   */
  template <int dim>
  class CellOverlap
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    static constexpr unsigned int n_sub_cells = SubCells<dim>::n_sub_cells;

    /** Integrals over a cell of after, with the functions Ψ of after (CellSimplices). */
    struct Integrals
    {
      std::array<double, n_corners * n_corners> matrix{}; ///< ∫ ρ Ψ_J Ψ_K
      std::array<double, n_corners> mass{};               ///< ∫ ρ Ψ_J
      std::vector<double> values; ///< ∫ ρ Ψ_J z, by field, corner and slot
    };

    /** The part of a sub-cell of before within one of after. */
    struct Share
    {
      unsigned int to;   ///< cell · n_sub_cells + sub-cell of this rank
      unsigned int from; ///< received cell · n_sub_cells + sub-cell
      double volume;
      dealii::Tensor<1, dim> moment; ///< ∫ x
    };

    /** A sub-cell of before, of this rank, as far as cells of after cover it. */
    struct Covered
    {
      double volume = 0;
      dealii::Tensor<1, dim> moment;
    };

    /** With nodal @p fields, node_stride slots each, ghosts current. @p cells must outlive this.
     * Collective. */
    CellOverlap(const std::vector<RemapCell<dim>> &cells,
                const std::vector<const NodalVector *> &fields, MPI_Comm communicator);

    /** Whether a cell has material before and moves, or moves and has some after. */
    bool is_source(const unsigned int cell) const
    {
      return cells[cell].has_moved() && !cells[cell].is_void_before;
    }
    bool is_target(const unsigned int cell) const
    {
      return cells[cell].has_moved() && !cells[cell].is_void_after;
    }

    /** Whether a cell of any rank has moved: otherwise nothing changes, and the results below are
     * empty. */
    bool has_motion = false;
    const std::vector<RemapCell<dim>> &cells;
    std::vector<Integrals> integrals; ///< of each cell of after
    std::vector<Covered> covered;     ///< of each sub-cell of before; cells that have moved only
    /** Whether a sub-cell of before has a mass and nothing of it is covered; empty where there is
     * none on any rank. */
    std::vector<bool> is_uncovered;
    std::vector<Share> shares; ///< of cells that have moved, ordered by `to`
    MPI_Comm communicator;

    /** Sends @p n values of each cell of before that has moved to the ranks that received it, in
     * the order of Share::from. Collective. */
    std::vector<double> forward(const std::vector<double> &cell_values, unsigned int n) const;

    /**
     * Distributes the mass of sub-cells of before that no cell of after covers (is_uncovered), and
     * what it carries, to those around that are covered, by their masses: first to all of cells
     * that share a node with theirs. They have no mass then. Sums over all sub-cells of m and of m
     * s stay to round-off.
     *
     * @p mass by cell and sub-cell [M]; @p values by cell, sub-cell and component, @p n_components
     * per mass. Throws a RunError with the position where none around can receive it. Collective.
     */
    void distribute_to_neighbours(const std::shared_ptr<const NodePartition> &partition,
                                  unsigned int n_components, std::vector<double> &mass,
                                  std::vector<double> &values) const;

  private:
    using Received = ReceivedCell<dim>;

    void send_cells(const std::vector<const NodalVector *> &fields);
    /** Distributes all of the mass of cells that are cut to their covered part, after this is
     * determined. Simplices with the same density as before do not count any more. Collective. */
    void change_densities(std::vector<Received> &received,
                          const std::shared_ptr<const NodePartition> &partition);
    void add_unmoved(unsigned int cell, const std::vector<const NodalVector *> &fields);
    /** Sends the covered parts of received cells back to their owners. Collective. */
    void return_covered(const std::vector<Received> &received);

    unsigned int n_fields;
    bool has_cut_cells = false;                             ///< on any rank
    std::map<unsigned int, std::vector<unsigned int>> sent; ///< cells, by rank
    std::map<unsigned int, unsigned int> n_received;        ///< by rank
    std::vector<double> received_data;
  };

  extern template class CellOverlap<2>;
  extern template class CellOverlap<3>;
} // namespace tombolo
