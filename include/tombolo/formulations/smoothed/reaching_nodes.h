// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/smoothed/node_cloud.h>

#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /** Finds the nodes of a cloud whose supports reach cells. Refers to the cloud. */
  template <int dim>
  class ReachingNodes
  {
  public:
    explicit ReachingNodes(const NodeCloud<dim> &cloud)
        : cloud(cloud), boxes(cloud.boxes()), tree(pack_rtree_of_indices(boxes))
    {}

    /** All that reach a cell: places in the cloud, ascending, until the next call. */
    const std::vector<std::size_t> &all(const SmoothedCell<dim> &cell)
    {
      found.clear();
      tree.query(boost::geometry::index::intersects(cell.box()), std::back_inserter(found));
      std::sort(found.begin(), found.end());
      return found;
    }

    /** Those of the last call of all() that are in full cells of the same body as @p cell. */
    void select(const SmoothedCell<dim> &cell, std::vector<std::size_t> &result) const
    {
      const double body = cloud.body.empty() ? 0. : cloud.body[cloud.place_of(cell.nodes.front())];
      result.clear();
      for (const std::size_t i : found)
        if ((cloud.is_void.empty() || !cloud.is_void[i]) &&
            (cloud.body.empty() || cloud.body[i] == body))
          result.push_back(i);
    }

  private:
    const NodeCloud<dim> &cloud;
    std::vector<dealii::BoundingBox<dim>> boxes;
    decltype(pack_rtree_of_indices(boxes)) tree;
    std::vector<std::size_t> found;
  };
} // namespace tombolo
