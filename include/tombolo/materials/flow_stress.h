// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/registry.h>

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
} // namespace tombolo
