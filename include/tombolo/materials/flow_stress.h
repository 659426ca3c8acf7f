// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/registry.h>

#include <cmath>
#include <limits>

namespace tombolo
{
  /** What a flow stress is evaluated at: n points, a multiple of n_lanes; no arrays overlap. */
  struct FlowStressBatch
  {
    unsigned int n;                   ///< number of points
    double inverse_time_increment;    ///< 1/Δt [1/T]; zero for an infinitely slow step
    const double *plastic_strain;     ///< effective plastic strain at the end of the step
    const double *increment;          ///< its increment Δp in the step, at least zero
    const double *temperature;        ///< at the end of the step; nullptr if not needed
    const double *temperature_change; ///< d temperature / dΔp; nullptr if not needed

    double *flow_stress; ///< out: σ_y, at least zero [M/(L T^2)]
    double *slope;       ///< out: dσ_y/dΔp, with the rate and the temperature changing with Δp
  };

  /** The stress at which a material flows, in batches. */
  class FlowStress
  {
  public:
    virtual ~FlowStress() = default;

    virtual bool depends_on_temperature() const = 0;

    /** Throws the InputError that the material must not start at this temperature. */
    virtual void check_initial_temperature(double /*temperature*/) const {}

    virtual void evaluate(const FlowStressBatch &batch) const = 0;

    /** The temperature from which on there is none; infinity: there is no such one. */
    virtual double melts_at() const
    {
      return std::numeric_limits<double>::infinity();
    }

    /** The cost of all evaluations of a step for a point, in the mean of a run in which some points
     * flow, in the units of Material::cost_per_point(). */
    virtual double cost_per_point() const
    {
      return 10.;
    }
  };

  template <>
  struct PluginKind<FlowStress>
  {
    static constexpr const char *name = "flow stress";
  };

  /**
   * The factor 1 + (ε̇_p / C)^(1/P) of a flow stress at the plastic strain rate ε̇_p (Cowper and
   * Symonds 1957). Below a millionth of C the power is replaced by its chord, since its slope has
   * no bound there.
   */
  class CowperSymonds
  {
  public:
    CowperSymonds() = default;

    explicit CowperSymonds(const Entries &e)
        : reference_rate(e.number("Cowper-Symonds rate", "0", zero_or_positive(), "1/T",
                                  "C of a factor $1 + (\\dot\\varepsilon_p/C)^{1/P}$; 0: none.")),
          exponent(1. /
                   e.number("Cowper-Symonds exponent", "5", between(1., 1000.), "1", "P of it."))
    {}

    bool is_on() const
    {
      return reference_rate > 0.;
    }

    /** Multiplies the flow stress in @p batch, with its slope. */
    void apply(const FlowStressBatch &batch) const
    {
      if (!is_on())
        return;
      constexpr double smallest = 1e-6;
      const double chord_slope = std::pow(smallest, exponent) / smallest;
      const double rate_of_increment = batch.inverse_time_increment / reference_rate;
      for (unsigned int i = 0; i < batch.n; ++i)
      {
        const double rate = rate_of_increment * batch.increment[i];
        const double power = rate > smallest ? std::pow(rate, exponent) : chord_slope * rate;
        const double slope = rate > smallest ? exponent * power / rate : chord_slope;
        batch.slope[i] =
            batch.slope[i] * (1. + power) + batch.flow_stress[i] * slope * rate_of_increment;
        batch.flow_stress[i] *= 1. + power;
      }
    }

  private:
    double reference_rate = 0.; ///< C [1/T]
    double exponent = 1.;       ///< 1/P
  };
} // namespace tombolo
