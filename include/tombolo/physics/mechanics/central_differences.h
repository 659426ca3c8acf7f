// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/physics/mechanics/motion_integrator.h>

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
  class CentralDifferences : public MotionIntegrator<dim>
  {
  public:
    CentralDifferences() = default;
    explicit CentralDifferences(const Section &) {}
    static void declare_parameters(dealii::ParameterHandler &handler);

    void advance(Model<dim> &model, const Clock &clock) override;

  private:
    NodalVector rate, field; // scratch, where velocities are sharpened
  };
} // namespace tombolo
