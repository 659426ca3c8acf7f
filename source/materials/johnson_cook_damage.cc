// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/materials/ductile_damage.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

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
      static void declare_parameters(ParameterHandler &handler);
      explicit JohnsonCookDamage(const Section &section);

      bool depends_on_temperature() const override
      {
        return d[4] != 0.;
      }

      void evaluate(FailureStrainBatch &batch) const override;

    private:
      template <bool with_temperature>
      void evaluate_batch(FailureStrainBatch &batch) const;

      double d[5];                       // D₁ to D₅
      double smallest;                   // of ε_f
      double reference_rate = 1.;        // ε̇₀ [1/T]
      double reference_temperature = 0.; // T_r [temperature]
      double inverse_range = 0.;         // 1/(T_m - T_r)
    };

    void JohnsonCookDamage::declare_parameters(ParameterHandler &handler)
    {
      Parameters::declare_mandatory(handler, "D1", Patterns::Double(),
                                    "$D_1$ of the strain at failure $(D_1 + D_2 e^{D_3 \\sigma^*}) "
                                    "(1 + D_4 \\ln \\dot\\varepsilon^*) (1 + D_5 T^*)$, with the "
                                    "stress triaxiality $\\sigma^*$. Units: 1.");
      Parameters::declare_mandatory(handler, "D2", Patterns::Double(),
                                    "$D_2$ of the same; $D_1 + D_2$ is the strain at failure in "
                                    "slow shear, larger than zero. Units: 1.");
      Parameters::declare_mandatory(handler, "D3", Patterns::Double(),
                                    "$D_3$ of the same, below zero where tension makes a metal "
                                    "less ductile: some books write the minus sign into the law. "
                                    "Units: 1.");
      handler.declare_entry("D4", "0", Patterns::Double(), "$D_4$ of the same. Units: 1.");
      handler.declare_entry("D5", "0", Patterns::Double(), "$D_5$ of the same. Units: 1.");
      Parameters::declare_mandatory(handler, "Reference rate", Patterns::Double(),
                                    "The rate at and below which the rate has no effect; where D4 "
                                    "is not zero. Units: 1/T.");
      Parameters::declare_mandatory(handler, "Melting temperature", Patterns::Double(),
                                    "$T_m$; where D5 is not zero.");
      Parameters::declare_mandatory(handler, "Reference temperature", Patterns::Double(),
                                    "$T_r$: up to here the temperature has no effect; where D5 is "
                                    "not zero.");
      handler.declare_entry("Smallest failure strain", "1e-6", Patterns::Double(),
                            "The strain at failure is at least this, larger than zero. Units: 1.");
    }

    JohnsonCookDamage::JohnsonCookDamage(const Section &section)
        : d{section.get_double("D1"), section.get_double("D2"), section.get_double("D3"),
            section.get_double("D4"), section.get_double("D5")},
          smallest(section.get_positive("Smallest failure strain"))
    {
      if (!(d[0] + d[1] > 0.))
        section.fail("D2", "D1 + D2, the strain at failure in slow shear, is not positive; allowed "
                           "is a number above -D1.");
      if (d[3] != 0. || section.is_set("Reference rate"))
        reference_rate = section.get_positive("Reference rate");
      if (d[4] == 0. && !section.is_set("Melting temperature") &&
          !section.is_set("Reference temperature"))
        return;
      reference_temperature = section.get_double("Reference temperature");
      const double melting_temperature = section.get_double("Melting temperature");
      if (!(melting_temperature > reference_temperature))
        section.fail("Melting temperature",
                     "allowed is a number above the reference temperature, " +
                         section.get("Reference temperature") + ".");
      inverse_range = 1. / (melting_temperature - reference_temperature);
    }

    void JohnsonCookDamage::evaluate(FailureStrainBatch &batch) const
    {
      if (depends_on_temperature())
        evaluate_batch<true>(batch);
      else
        evaluate_batch<false>(batch);
    }

    template <bool with_temperature>
    void JohnsonCookDamage::evaluate_batch(FailureStrainBatch &batch) const
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
        const double wanted = d3 * triaxiality[i];
        const double above = wanted > -largest_exponent ? wanted : -largest_exponent;
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
  } // namespace

  TOMBOLO_REGISTER(DuctileDamage, JohnsonCookDamage, "johnson cook damage",
                   "plastic strain at failure by stress triaxiality, rate and temperature (Johnson "
                   "and Cook 1985)")
} // namespace tombolo
