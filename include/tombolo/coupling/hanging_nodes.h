// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/index_set.h>

#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Nodes that are no unknowns: each lies on the face of an element beside elements of half its
   * size, and has the mean of the nodes between which it lies, C. Fields of elements are then
   * continuous. Forces and masses of such nodes go to the others by Cᵀ, so that a node that hangs
   * has no mass and takes no force. The rows of C sum to one and keep linear fields, hence Cᵀ keeps
   * mass, momentum and angular momentum, and f · C v = Cᵀ f · v.
   *
   * A node between which another one hangs can hang itself, where cells change their size
   * repeatedly. Rows are therefore applied as often as the longest such chain is.
   */
  class HangingNodes
  {
  public:
    /** A node and the weights of those between which it lies. */
    struct Row
    {
      dealii::types::global_dof_index node;
      std::vector<std::pair<dealii::types::global_dof_index, double>> weights;
    };

    /** @p rows of nodes that this rank owns. @p n_nodes is the number of nodes of the mesh. */
    HangingNodes(const std::vector<Row> &rows, dealii::types::global_dof_index n_nodes);

    /** Those that this rank owns. */
    const std::vector<Row> &owned_rows() const;

    /** How many nodes the longest chain of nodes that hang between hanging nodes has, over all
     * ranks, since set_partition(). */
    unsigned int longest_chain() const;

    /** The nodes whose values this rank must see. */
    const dealii::IndexSet &required_nodes() const;

    /** Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    /** Gives hanging nodes the mean of the others, in any field, and updates its ghosts.
     * Collective. */
    void interpolate(NodalVector &field) const;

    /** Moves what owned hanging nodes have to the nodes between which they lie, Cᵀ. Ghosts of @p
     * values must be zero, and are zero afterwards. Collective. */
    void collect(NodalVector &values) const;

    std::size_t memory_consumption() const;

  private:
    std::vector<Row> rows;
    dealii::IndexSet node_set;

    // Rows one after the other, in local numbers.
    std::vector<unsigned int> hanging;
    std::vector<std::size_t> first_weight;
    std::vector<std::pair<unsigned int, double>> weights;
    unsigned int depth = 1; ///< of the longest chain of nodes that hang between hanging nodes
  };

  /** interpolate() with @p nodes, or, where they are null, the ghosts alone. Collective. */
  void update_ghosts(const std::shared_ptr<const HangingNodes> &nodes, NodalVector &field);

  /** collect() of @p nodes, which may be null. Collective. */
  void collect(const std::shared_ptr<const HangingNodes> &nodes, NodalVector &values);

  /** Some @p owned nodes of a @p partition and those that collect() moves to what they have,
   * without ghosts, ascending. @p nodes may be null. Collective. */
  std::vector<unsigned int> with_nodes_around(const std::shared_ptr<const HangingNodes> &nodes,
                                              const std::shared_ptr<const NodePartition> &partition,
                                              std::vector<unsigned int> owned);
} // namespace tombolo
