// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/parameters.h>
#include <tombolo/materials/equation_of_state.h>

namespace tombolo
{
  namespace
  {
    /**
     * With μ = ρ/ρ₀ - 1 = 1/J - 1, in compression
     * @verbatim
     * p = ρ₀ c₀² μ (1 + (1 - γ₀/2) μ - a/2 μ²) / d² + (γ₀ + a μ) E,
     * d = 1 - (s₁ - 1) μ - s₂ μ²/(μ + 1) - s₃ μ³/(μ + 1)²,
     * @endverbatim
     * and in expansion p = ρ₀ c₀² μ + (γ₀ + a μ) E: the shock speed is
     * c₀ + s₁ u_p + s₂ (u_p/U_s) u_p + s₃ (u_p/U_s)² u_p at the particle speed u_p (Steinberg 1996;
     * *EOS_GRUNEISEN of LS-DYNA).
     */
    class MieGruneisen : public EquationOfState
    {
    public:
      explicit MieGruneisen(const Entries &e)
      {
        const double speed =
            e.number("Sound speed", mandatory, positive(), "L/T",
                     "$c_0$, the speed of sound without shear stiffness, where the "
                     "line of the shock speed begins.");
        slope[0] = e.number("Hugoniot slope", mandatory, zero_or_positive(), "1",
                            "$s_1$ of the shock speed $U_s = c_0 + s_1 u_p$ at the particle speed "
                            "$u_p$, zero or positive.");
        slope[1] = e.number("Second Hugoniot coefficient", "0", any_number(), "1",
                            "$s_2$, of $(u_p/U_s) u_p$ in the shock speed.");
        slope[2] = e.number("Third Hugoniot coefficient", "0", any_number(), "1",
                            "$s_3$, of $(u_p/U_s)^2 u_p$ in the shock speed.");
        gruneisen = e.number("Gruneisen coefficient", mandatory, from_to(0., 10.), "1",
                             "$\\gamma_0$, the pressure that internal energy per initial volume "
                             "makes, from 0 to 10.");
        first_order_volume_exponent =
            e.number("Gruneisen correction", "0", any_number(), "1",
                     "$a$: the coefficient is $\\gamma_0 + a (\\rho/\\rho_0 - 1)$.");
        if (!e.declares())
          stiffness = e.section().parent().get_positive("Density") * speed * speed;
      }

      double bulk_modulus() const override
      {
        return stiffness;
      }

      void evaluate(EquationOfStateBatch &batch) const override
      {
        // d is zero where the shock would be infinitely strong.
        constexpr double smallest_denominator = 1e-3;
        const double k = stiffness, s1 = slope[0], s2 = slope[1], s3 = slope[2], g = gruneisen,
                     a = first_order_volume_exponent;
        const double *const relative_volume = batch.relative_volume;
        double *const reference = batch.reference, *const modulus = batch.reference_modulus;
        double *const coefficient = batch.coefficient, *const change = batch.coefficient_change;
#pragma GCC ivdep
        for (unsigned int i = 0; i < batch.n; ++i)
        {
          const double density = 1. / relative_volume[i]; // over the initial one
          const double mu = density - 1.;
          const double eta = mu * relative_volume[i];
          const double numerator = mu * (1. + mu * (1. - 0.5 * g - 0.5 * a * mu));
          const double numerator_slope = 1. + mu * (2. - g - 1.5 * a * mu);
          // μ²/(μ+1) = μ η and μ³/(μ+1)² = μ η², with dη/dμ = J².
          const double d = 1. - mu * (s1 - 1. + eta * (s2 + eta * s3));
          const double inverse = 1. / (d > smallest_denominator ? d : smallest_denominator);
          const double d_slope =
              -(s1 - 1. + eta * (s2 + eta * s3)) - eta * relative_volume[i] * (s2 + 2. * eta * s3);
          const bool is_compressed = mu > 0.;
          const double squared = inverse * inverse;
          reference[i] = k * (is_compressed ? numerator * squared : mu);
          const double slope_of_compression =
              squared * (numerator_slope - 2. * numerator * inverse * d_slope);
          // -J d/dJ = (1 + μ) d/dμ.
          modulus[i] = k * density * (is_compressed ? slope_of_compression : 1.);
          coefficient[i] = g + a * mu;
          change[i] = a * density;
        }
      }

    private:
      double stiffness;                   // ρ₀ c₀² [M/(L T^2)]
      double slope[3];                    // s₁, s₂, s₃
      double gruneisen;                   // γ₀
      double first_order_volume_exponent; // a
    };

  } // namespace

  TOMBOLO_REGISTER(EquationOfState, MieGruneisen, "mie gruneisen",
                   "the pressure of strong shocks by a line of shock over particle speed and "
                   "Gruneisen's coefficient")
} // namespace tombolo
