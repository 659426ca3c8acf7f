// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>
#include <tombolo/state/nodal_vector.h>

#include <memory>
#include <vector>

namespace tombolo
{
  struct PointValues;
  template <int dim>
  struct RemapCell;

  /**
   * How a refill carries fields over where a plug-in does it, which `Refill remap` names: nodes and
   * points that have moved get values at their new positions. The remap of the library itself,
   * `conservative`, keeps sums; of these remaps the refill accounts for what they change, and
   * scales masses so that their sum stays. One object serves one part. Collective.
   */
  template <int dim>
  class ValueRemap
  {
  public:
    virtual ~ValueRemap() = default;

    /** Sets @p fields of owned nodes that go from @p before to @p after to their values at the new
     * positions, and updates ghosts of the fields. Nodes of other parts may be among them. Fields
     * have node_stride slots each: velocities, and temperatures where there is heat. */
    virtual void remap_nodes(const std::vector<RemapCell<dim>> &cells, const NodalVector &before,
                             const NodalVector &after,
                             const std::vector<NodalVector *> &fields) const = 0;

    /** Sets the values of @p points at the new positions of points of cells that have moved; masses
     * stay. @p corner_shares: those of the corners of its cell in the position of each point. */
    virtual void remap_points(const std::vector<RemapCell<dim>> &cells,
                              const std::shared_ptr<const NodePartition> &partition,
                              const std::vector<std::vector<double>> &corner_shares,
                              PointValues &points) const = 0;
  };

  template <int dim>
  struct PluginKind<ValueRemap<dim>>
  {
    static constexpr const char *name = "remap";
  };
} // namespace tombolo
