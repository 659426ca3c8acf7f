// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/johnson_cook.h>

#include <tombolo/base/simd/vector_math.h>

#include <cmath>
#include <sstream>

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

  using namespace dealii;

  void JohnsonCook::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(handler, "Yield stress", Patterns::Double(),
                                  "$A$, larger than zero. Units: M/(L T^2).");
    Parameters::declare_mandatory(handler, "Hardening coefficient", Patterns::Double(),
                                  "$B$, zero or positive. Units: M/(L T^2).");
    Parameters::declare_mandatory(handler, "Hardening exponent", Patterns::Double(),
                                  "$n$, above 0 and up to 2. Units: 1.");
    Parameters::declare_mandatory(handler, "Rate coefficient", Patterns::Double(),
                                  "$C$, from 0 to 1. Units: 1.");
    Parameters::declare_mandatory(
        handler, "Reference rate", Patterns::Double(),
        "$\\dot\\varepsilon_0$: at this rate and below the flow stress is that of a slow test; "
        "beware of its units. Units: 1/T.");
    Parameters::declare_mandatory(handler, "Thermal exponent", Patterns::Double(),
                                  "$m$, above 0 and up to 10. Units: 1.");
    Parameters::declare_mandatory(handler, "Melting temperature", Patterns::Double(),
                                  "$T_m$: from here on there is no flow stress.");
    Parameters::declare_mandatory(handler, "Reference temperature", Patterns::Double(),
                                  "$T_r$: up to here there is no thermal softening.");
  }

  JohnsonCook::JohnsonCook(const Section &section)
      : section(section), yield_stress(section.get_positive("Yield stress")),
        hardening_coefficient(section.get_double("Hardening coefficient")),
        hardening_exponent(section.get_double("Hardening exponent")),
        rate_coefficient(section.get_double("Rate coefficient")),
        reference_rate(section.get_positive("Reference rate")),
        thermal_exponent(section.get_double("Thermal exponent")),
        melting_temperature(section.get_double("Melting temperature")),
        reference_temperature(section.get_double("Reference temperature"))
  {
    if (!(hardening_coefficient >= 0. && std::isfinite(hardening_coefficient)))
      section.fail("Hardening coefficient", "allowed is zero or a positive number.");
    if (!(hardening_exponent > 0. && hardening_exponent <= 2.))
      section.fail("Hardening exponent", "allowed is a number above 0 and up to 2.");
    if (!(rate_coefficient >= 0. && rate_coefficient <= 1.))
      section.fail("Rate coefficient", "allowed is a number from 0 to 1.");
    if (!(thermal_exponent > 0. && thermal_exponent <= 10.))
      section.fail("Thermal exponent", "allowed is a number above 0 and up to 10.");
    if (!std::isfinite(reference_temperature))
      section.fail("Reference temperature", "allowed is a finite number.");
    if (!(melting_temperature > reference_temperature && std::isfinite(melting_temperature)))
      section.fail("Melting temperature", "allowed is a number above the reference temperature, " +
                                              section.get("Reference temperature") + ".");
  }

  bool JohnsonCook::depends_on_temperature() const
  {
    return true;
  }

  void JohnsonCook::check_initial_temperature(const double temperature) const
  {
    if (!(melting_temperature > temperature))
    {
      std::ostringstream message;
      message << "the material would be molten from the start: allowed is a number above its "
                 "initial temperature, "
              << temperature << ".";
      section.fail("Melting temperature", message.str());
    }
  }

  void JohnsonCook::evaluate(const FlowStressBatch &batch) const
  {
    if (batch.inverse_time_increment > 0.)
      evaluate_batch<true>(batch);
    else
      evaluate_batch<false>(batch);
  }

  template <bool has_rate>
  void JohnsonCook::evaluate_batch(const FlowStressBatch &batch) const
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
      slope[i] = (exponent * hardening / p * rate_factor + strength * rate_slope) * thermal_factor -
                 strength * rate_factor * thermal_slope * temperature_change[i];
    }
  }

  TOMBOLO_REGISTER(FlowStress, JohnsonCook, "johnson cook",
                   "hardening by a power of the plastic strain, the logarithm of its rate, and "
                   "thermal softening (Johnson and Cook 1983)")
} // namespace tombolo
