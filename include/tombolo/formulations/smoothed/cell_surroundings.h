// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/smoothed_cell.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tombolo
{
  /** The nodes of a part that can be neighbours of points in its cells on this rank, ascending by
   * their global numbers. */
  template <int dim>
  struct NodeCloud
  {
    /** Half widths of supports are @p dilation times the largest distance to a node of the same
     * cell, axis by axis. Collective. */
    NodeCloud(const PartSetup<dim> &setup, double dilation,
              const std::vector<SmoothedCell<dim>> &cells);

    /** The place of a node that is there. */
    unsigned int place_of(dealii::types::global_dof_index number) const;

    /** The supports. */
    std::vector<dealii::BoundingBox<dim>> boxes() const;

    std::vector<dealii::types::global_dof_index> node;
    std::vector<double> position, support; ///< node_stride each [L]
    std::vector<double> body;              ///< its number in Bodies; empty: there is one
    std::vector<bool> is_void;             ///< whether all of its cells are void; empty: none is
  };

  /** The facets (SubCells) that two full cells of this rank have in common, without those of cells
   * with faces towards smaller ones. */
  template <int dim>
  class SharedFacets
  {
  public:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    explicit SharedFacets(const std::vector<SmoothedCell<dim>> &cells);

    /** The number that a facet has in both cells, or none. */
    unsigned int number(const std::size_t cell, const std::size_t facet) const
    {
      return numbers[cell * SubCells<dim>::facets().size() + facet];
    }

    unsigned int size() const
    {
      return n_shared;
    }

  private:
    struct Face;

    void match(const std::vector<SmoothedCell<dim>> &cells, const Face &first, const Face &second);

    std::vector<unsigned int> numbers; // by cell and facet
    unsigned int n_shared = 0;
  };

  /** The cells of a part and the nodes whose supports reach them, in the initial configuration. */
  template <int dim>
  class CellSurroundings
  {
  public:
    /** Collective. */
    CellSurroundings(const PartSetup<dim> &setup, double dilation);

    std::vector<SmoothedCell<dim>> cells;
    NodeCloud<dim> cloud;
    SharedFacets<dim> shared_facets;

    /** The nodes in full cells of the same body whose supports reach a cell: places in the cloud,
     * ascending. */
    void find_neighbours(std::size_t cell, std::vector<std::size_t> &result) const;

    /** Whether the support of a node reaches a cell, void ones too; by the place in the cloud. */
    std::vector<bool> reaches_cells() const;

  private:
    std::vector<unsigned int> reaching; // places in the cloud, cell by cell
    std::vector<std::size_t> first;     // of each cell
  };
} // namespace tombolo
