// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/oblique_nodes.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * How the positions at t_{n+1} follow from the accelerations at t_n, and respond to forces at
   * positions, for the smoothing of a Bridge:
   *
   * @verbatim
   *   x_{n+1} = x_n + Δt (B_v v + Δt_n B a),   B_v = B = Φ, or with affine smoothing I and S S*
   *   Δx = Δt Δt_n A f,   A = B M⁻¹ Bᵀ_f,      Bᵀ_f = Φᵀ, or with affine smoothing I
   * @endverbatim
   *
   * The eigenvalues of A are at most those of the inverse of mass(); with affine smoothing, some
   * are larger by a few percent where nodes are disordered. Prescribed components do not respond.
   */
  class PositionResponse
  {
  public:
    /** @p bridge must outlive this. */
    explicit PositionResponse(Bridge &bridge) : bridge(bridge) {}

    /** Whether predict() costs as much as moving all nodes. */
    bool is_global() const
    {
      return bridge.operators() == Bridge::Operators::affine;
    }

    /** Before other calls, with the present partition. */
    void begin_step(const std::shared_ptr<const NodePartition> &partition);

    /** The positions at t_{n+1} of owned @p nodes to @p predicted. The acceleration has current
     * ghosts. Collective. */
    void predict(const NodalState &state, const Clock &clock,
                 const std::vector<unsigned int> &nodes, NodalVector &predicted);

    /** Sets the owned nodes, ascending, at which forces act and responses are needed.
     * Collective. */
    void set_nodes(const std::vector<unsigned int> &nodes);

    /** Instead, where rows, partition and prescribed components are those of the last call of
     * set_nodes(): the same nodes. */
    void keep_nodes()
    {
      for (NodalVector *const vector : {&force, &field, &rate})
        vector->set_zero();
    }

    /** A of the @p loads at these nodes to @p response; @p constrained has a bit per prescribed
     * component of each owned node, or is empty, and those of @p oblique nodes do not respond along
     * prescribed axes of their frames. Collective. */
    void respond(const NodalVector &loads, const std::vector<std::uint8_t> &constrained,
                 NodalVector &response, const ObliqueNodes &oblique = {});

    /** Scalar, or by component: what bounds A. */
    const NodalVector &mass() const
    {
      return is_global() ? bridge.nodal_mass() : bridge.mass();
    }

  private:
    void respond_affine(const std::vector<std::uint8_t> &constrained, const ObliqueNodes &oblique,
                        NodalVector &response);
    /** Nodes where forces, accelerations and rates can be different from zero, given those that
     * rows of this rank @p reached. Collective. */
    void find_touched_nodes(const std::vector<unsigned int> &reached);
    /** The nodal acceleration by forces in `force`, at owned touched nodes. */
    void divide_by_mass(const std::vector<std::uint8_t> &constrained, const ObliqueNodes &oblique);

    Bridge &bridge;
    std::vector<unsigned int> nodes_of_forces;
    std::vector<std::size_t> own;                     // indices into the own nodes of the split
    std::vector<std::vector<unsigned int>> rows;      // by part, that have such a node as neighbour
    std::vector<unsigned int> touched, touched_owned; // ascending
    NodalVector force, field, rate;
    NodalVector mark; // scalar
  };
} // namespace tombolo
