// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/materials/ductile_damage.h>

#include <cmath>

namespace tombolo
{
  namespace
  {
    /**
     * ε_f = (D₁ + D₂ exp(D₃ σ*)) (1 + D₄ ln(ε̇_p/ε̇₀)) (1 + D₅ T*), σ* = mean stress over von Mises
     * stress, T* = (T - T_r)/(T_m - T_r) (Johnson and Cook 1985). The factor of the rate is 1 below
     * ε̇₀, and T* stays in [0, 1]; ε_f is never below a smallest one.
     */
    class JohnsonCookDamage : public DuctileDamage
    {
    public:
      explicit JohnsonCookDamage(const Entries &e)
      {
        d[0] = e.number(
            "D1", mandatory, any_number(), "1",
            "$D_1$ of the strain at failure $(D_1 + D_2 e^{D_3 \\sigma^*}) (1 + D_4 \\ln "
            "\\dot\\varepsilon^*) (1 + D_5 T^*)$, with the stress triaxiality $\\sigma^*$.");
        d[1] = e.number("D2", mandatory, any_number(), "1",
                        "$D_2$ of the same; $D_1 + D_2$ is the strain at failure in slow shear, "
                        "larger than zero.");
        d[2] = e.number("D3", mandatory, any_number(), "1",
                        "$D_3$ of the same, below zero where tension makes a metal less ductile: "
                        "some books write the minus sign into the law.");
        d[3] = e.number("D4", "0", any_number(), "1", "$D_4$ of the same.");
        d[4] = e.number("D5", "0", any_number(), "1", "$D_5$ of the same.");
        e.refuse(
            !(d[0] + d[1] > 0.), "D2",
            "D1 + D2, the strain at failure in slow shear, is not positive; allowed is a number "
            "above -D1.");
        if (e.when(d[3] != 0. || e.is_set("Reference rate")))
          reference_rate =
              e.number("Reference rate", mandatory, positive(), "1/T",
                       "The rate at and below which the rate has no effect; where D4 is not zero.");
        if (e.when(d[4] != 0. || e.is_set("Melting temperature") ||
                   e.is_set("Reference temperature")))
        {
          const double melting_temperature = e.number(
              "Melting temperature", mandatory, any_number(), "", "$T_m$; where D5 is not zero.");
          reference_temperature =
              e.number("Reference temperature", mandatory, any_number(), "",
                       "$T_r$: up to here the temperature has no effect; where D5 is not zero.");
          e.refuse(!(melting_temperature > reference_temperature), "Melting temperature",
                   "allowed is a number above the reference temperature, " +
                       e.given("Reference temperature") + ".");
          if (!e.declares())
            inverse_range = 1. / (melting_temperature - reference_temperature);
        }
        smallest = e.number("Smallest failure strain", "1e-6", positive(), "1",
                            "The strain at failure is at least this, larger than zero.");
      }

      bool depends_on_temperature() const override
      {
        return d[4] != 0.;
      }

      void evaluate(FailureStrainBatch &batch) const override
      {
        if (depends_on_temperature())
          evaluate_batch<true>(batch);
        else
          evaluate_batch<false>(batch);
      }

    private:
      template <bool with_temperature>
      void evaluate_batch(FailureStrainBatch &batch) const
      {
        // exp(±50) is beyond all strains, and far from overflow.
        constexpr double largest_exponent = 50.;
        const double d1 = d[0], d2 = d[1], d3 = d[2], d4 = d[3], d5 = d[4], floor = smallest;
        const double inverse_rate = 1. / reference_rate, reference = reference_temperature,
                     inverse = inverse_range;
        const double *const triaxiality = batch.triaxiality, *const rate = batch.rate,
                            *const temperature = batch.temperature;
        double *const failure_strain = batch.failure_strain;
#pragma GCC ivdep
        for (unsigned int i = 0; i < batch.n; ++i)
        {
          const double argument = d3 * triaxiality[i];
          const double above = argument > -largest_exponent ? argument : -largest_exponent;
          const double exponent = above < largest_exponent ? above : largest_exponent;
          const double relative_rate = inverse_rate * rate[i];
          double strain = (d1 + d2 * std::exp(exponent)) *
                          (1. + d4 * std::log(relative_rate > 1. ? relative_rate : 1.));
          if constexpr (with_temperature)
          {
            const double t = inverse * (temperature[i] - reference);
            const double positive = t > 0. ? t : 0.;
            strain *= 1. + d5 * (positive < 1. ? positive : 1.);
          }
          failure_strain[i] = strain > floor ? strain : floor;
        }
      }

      double d[5];                       // D₁ to D₅
      double smallest;                   // of ε_f
      double reference_rate = 1.;        // ε̇₀ [1/T]
      double reference_temperature = 0.; // T_r [temperature]
      double inverse_range = 0.;         // 1/(T_m - T_r)
    };

  } // namespace

  TOMBOLO_REGISTER(DuctileDamage, JohnsonCookDamage, "johnson cook damage",
                   "plastic strain at failure by stress triaxiality, rate and temperature (Johnson "
                   "and Cook 1985)")
} // namespace tombolo
