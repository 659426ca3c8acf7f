// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/flow_stress.h>

namespace tombolo
{
  /**
   * σ_y = (A + B ε_pⁿ)(1 + C ln(ε̇_p/ε̇₀))(1 - T*ᵐ), T* = (T - T_r)/(T_m - T_r) (Johnson and Cook
   * 1983). The factor of the rate is 1 below ε̇₀, and T* stays in [0, 1]: a molten point carries no
   * deviatoric stress.
   */
  class JohnsonCook : public FlowStress
  {
  public:
    explicit JohnsonCook(const Entries &e);
    bool depends_on_temperature() const override;
    void check_initial_temperature(double temperature) const override;
    void evaluate(const FlowStressBatch &batch) const override;
    double cost_per_point() const override
    {
      return 40.; // of points that are elastic and points that flow
    }

  private:
    template <bool has_rate>
    void evaluate_batch(const FlowStressBatch &batch) const;

    Section section;
    double yield_stress;          // A [M/(L T^2)]
    double hardening_coefficient; // B [M/(L T^2)]
    double hardening_exponent;    // n
    double rate_coefficient;      // C
    double reference_rate;        // ε̇₀ [1/T]
    double thermal_exponent;      // m
    double melting_temperature;   // T_m [temperature]
    double reference_temperature; // T_r [temperature]
  };
} // namespace tombolo
