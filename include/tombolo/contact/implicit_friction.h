// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/nodal_vector.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  /** Coulomb's coefficient c = μ(T(c)) at the temperature that its own heat makes: @p heated(c) is
   * T with the heat of friction by the coefficient c, @p before that without any. By secants within
   * the bounds of the solution, so that a coefficient that ends at a temperature never heats beyond
   * it. */
  template <typename Heated>
  double implicit_coefficient(const TemperatureTable &friction, const double before,
                              const Heated &heated)
  {
    constexpr unsigned int most_iterations = 60;
    constexpr double tolerance = 1e-12;
    const auto excess = [&](const double c) { return friction.value(heated(c)) - c; };
    const double start = friction.value(before), start_excess = excess(start);
    if (start_excess == 0. || friction.is_constant())
      return start;
    // The excess is positive at the lower bound, negative at the upper one.
    double low = start_excess > 0. ? start : 0.,
           low_excess = start_excess > 0. ? start_excess : start;
    double high = start_excess > 0. ? friction.largest() : start;
    double high_excess = start_excess > 0. ? excess(high) : start_excess;
    if (!(low_excess > 0.) || !(high_excess < 0.))
      return high_excess < 0. ? low : high;
    double result = low;
    int last_side = 0;
    for (unsigned int n = 0; n < most_iterations && high - low > tolerance * friction.largest();
         ++n)
    {
      result = (low * high_excess - high * low_excess) / (high_excess - low_excess);
      const double value = excess(result);
      if (value == 0.)
        break;
      const int side = value > 0. ? 1 : -1;
      (side > 0 ? low : high) = result;
      (side > 0 ? low_excess : high_excess) = value;
      if (side == last_side) // the bound that stays holds the secant back
        (side > 0 ? high_excess : low_excess) *= 0.5;
      last_side = side;
      if (std::abs(value) <= tolerance * friction.largest())
        break;
    }
    return result;
  }

  /**
   * Friction over the temperature where the heat of a node goes to nodes around it, since particles
   * smooth: each of these receivers j has a coefficient m_j = μ(T_j) of its own, and
   *
   * @verbatim
   *   μ_i = Σ_j G_ij m_j,   H_j += m_j Σ_i G_ij q_i / μ_i,   G = Φ S
   * @endverbatim
   *
   * for a touching node i with the heat q_i. So friction ends for each receiver at its own
   * temperature, the heat is that of the work, and where all have one coefficient it is shared out
   * by Sᵀ Φᵀ as any other.
   */
  struct SpreadFriction
  {
    NodalVector weight;      ///< m_j, scalars with ghosts
    NodalVector coefficient; ///< μ_i of owned nodes that can touch, scalars
    NodalVector heat;        ///< q_i of owned nodes since the thermal step began, scalar
    /** Σ_i G_ij q_i / μ_i of the last thermal steps, which is expected to come again: scalar. */
    NodalVector unit_heat;
    bool is_outdated = true; ///< a thermal step has ended

    /** At an owned node. Once it has received much more heat in the thermal step than was expected,
     * the coefficient is at most that of the temperature @p present(), which includes this heat. */
    template <typename Present>
    double at(const unsigned int node, const TemperatureTable &friction,
              const Present &present) const
    {
      constexpr double much = 4.; // some of the heat of the node flows to others
      const double by_receivers = *coefficient.node(node);
      if (*heat.node(node) <= much * *weight.node(node) * *unit_heat.node(node))
        return by_receivers;
      return std::min(by_receivers, friction.value(present()));
    }
  };
} // namespace tombolo
