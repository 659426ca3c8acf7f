// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/material.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    /** x^exponent for x > 0: in vectors less than half the cost of pow, which carries the logarithm
     * in twice the digits. The relative error is some 1e-16 (1 + |exponent ln x|). */
    inline double power(const double x, const double exponent)
    {
      return std::exp(exponent * std::log(x));
    }
  } // namespace

  /**
   * σ_y = (A + B ε_pⁿ)(1 + C ln(ε̇_p/ε̇₀))(1 - T*ᵐ), T* = (T - T_r)/(T_m - T_r) (Johnson and Cook
   * 1983). The factor of the rate is 1 below ε̇₀, and T* stays in [0, 1]: a molten point carries no
   * deviatoric stress.
   */
  class JohnsonCook : public FlowStress
  {
  public:
    explicit JohnsonCook(const Entries &e) : section(e.section())
    {
      yield_stress =
          e.number("Yield stress", mandatory, positive(), "M/(L T^2)", "$A$, larger than zero.");
      hardening_coefficient = e.number("Hardening coefficient", mandatory, zero_or_positive(),
                                       "M/(L T^2)", "$B$, zero or positive.");
      hardening_exponent = e.number("Hardening exponent", mandatory, above_zero_up_to(2.), "1",
                                    "$n$, above 0 and up to 2.");
      rate_coefficient =
          e.number("Rate coefficient", mandatory, from_to(0., 1.), "1", "$C$, from 0 to 1.");
      reference_rate = e.number("Reference rate", mandatory, positive(), "1/T",
                                "$\\dot\\varepsilon_0$: at this rate and below the flow stress is "
                                "that of a slow test; beware of its units.");
      thermal_exponent = e.number("Thermal exponent", mandatory, above_zero_up_to(10.), "1",
                                  "$m$, above 0 and up to 10.");
      melting_temperature = e.number("Melting temperature", mandatory, any_number(), "",
                                     "$T_m$: from here on there is no flow stress.");
      reference_temperature = e.number("Reference temperature", mandatory, any_number(), "",
                                       "$T_r$: up to here there is no thermal softening.");
      e.refuse(!(melting_temperature > reference_temperature), "Melting temperature",
               "allowed is a number above the reference temperature, " +
                   e.given("Reference temperature") + ".");
    }

    bool depends_on_temperature() const override
    {
      return true;
    }

    double melts_at() const override
    {
      return melting_temperature;
    }

    void check_initial_temperature(const double temperature) const override
    {
      if (!(melting_temperature > temperature))
      {
        section.fail(
            "Melting temperature",
            as_text("the material would be molten from the start: allowed is a number above its "
                    "initial temperature, ",
                    temperature, "."));
      }
    }

    void evaluate(const FlowStressBatch &batch) const override
    {
      if (batch.inverse_time_increment > 0.)
        evaluate_batch<true>(batch);
      else
        evaluate_batch<false>(batch);
    }

    double cost_per_point() const override
    {
      return 40.; // of points that are elastic and points that flow
    }

  private:
    template <bool has_rate>
    void evaluate_batch(const FlowStressBatch &batch) const
    {
      // Arguments keep away from zero, where the vector logarithm falls back to the scalar one.
      constexpr double tiny = 1e-200;
      const double a = yield_stress, b = hardening_coefficient, exponent = hardening_exponent,
                   c = rate_coefficient, m = thermal_exponent, reference = reference_temperature;
      const double inverse_range = 1. / (melting_temperature - reference_temperature);
      const double relative_rate = batch.inverse_time_increment / reference_rate;
      const double *const strain = batch.plastic_strain;
      const double *const increment = batch.increment;
      const double *const temperature = batch.temperature;
      const double *const temperature_change = batch.temperature_change;
      double *const flow_stress = batch.flow_stress;
      double *const slope = batch.slope;
#pragma GCC ivdep
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        const double p = strain[i] > tiny ? strain[i] : tiny;
        const double hardening = b * power(p, exponent);
        const double strength = a + hardening;

        double rate_factor = 1., rate_slope = 0.;
        if constexpr (has_rate)
        {
          const double scaled_rate = relative_rate * increment[i];
          const bool is_fast = scaled_rate > 1.;
          const double rate = is_fast ? scaled_rate : 1.;
          rate_factor += c * std::log(rate);
          rate_slope = is_fast ? c * relative_rate / rate : 0.;
        }

        const double t = inverse_range * (temperature[i] - reference);
        const bool is_soft = t > tiny;
        const bool is_solid = t < 1.;
        const double clamped = is_solid ? (is_soft ? t : tiny) : 1.;
        const double softening = power(clamped, m);
        const double thermal_factor = is_solid ? 1. - softening : 0.;
        const double thermal_slope =
            is_soft && is_solid ? m * softening / clamped * inverse_range : 0.;

        flow_stress[i] = strength * rate_factor * thermal_factor;
        slope[i] =
            (exponent * hardening / p * rate_factor + strength * rate_slope) * thermal_factor -
            strength * rate_factor * thermal_slope * temperature_change[i];
      }
    }

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

  TOMBOLO_REGISTER(FlowStress, JohnsonCook, "johnson cook",
                   "hardening by a power of the plastic strain, the logarithm of its rate, and "
                   "thermal softening (Johnson and Cook 1983)")
} // namespace tombolo
