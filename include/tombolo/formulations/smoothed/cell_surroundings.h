// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>
#include <tombolo/formulations/smoothed/shared_facets.h>

#include <cstddef>
#include <vector>

namespace tombolo
{
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
