// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>

#include <cstddef>
#include <vector>

namespace tombolo
{
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
} // namespace tombolo
