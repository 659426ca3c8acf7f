// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/model/model.h>

namespace tombolo
{
  /**
   * Explicit central differences, eqs (22)-(25) and, at shared nodes, (52)-(56): with the bridge's
   * Φ and its sharpened form Φ_γ (I where there are elements only),
   *
   * @verbatim
   *   v̂ += Δt_n Φ_γ a
   *   x += Δt Φ (v + Δt_n a)
   * @endverbatim
   *
   * Affine smoothing differs from eq. (25): x += Δt v̂. Angular momentum is Σ x × m̂ v̂, and of all
   * increments only v̂ itself (or a self-adjoint operator on it that keeps linear fields, which
   * costs twice the smoothing) changes x without changing it and carries a rigid rotation exactly.
   */
  template <int dim>
  class CentralDifferences
  {
  public:
    /** From positions at t_n, unsmoothed velocities at t_{n-1/2} and the acceleration at t_n
     * (ghosts of all three and of the velocity are current) to positions at t_{n+1} and unsmoothed
     * velocities at t_{n+1/2}, with current ghosts. Collective. */
    void advance(Model<dim> &model, const Clock &clock);

  private:
    NodalVector rate, field; // scratch, where velocities are sharpened
  };
} // namespace tombolo
