// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/material_points.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * An artificial pressure that acts in compression only,
   * q = ρ l (c₁ c |tr D| + c₂ l (tr D)²), with the length l = V^(1/dim) of the point and the speed
   * c of P waves: it spreads shocks over a few points and damps the ringing behind them. It belongs
   * to the force, not to the stored stress. Without it points have no fields of it and forces need
   * one test per eight points.
   */
  class BulkViscosity
  {
  public:
    /** None. */
    BulkViscosity() = default;
    explicit BulkViscosity(const Entries &e);
    bool is_on() const
    {
      return linear > 0. || quadratic > 0.;
    }

    /** The fields that points need; none if off. */
    std::vector<FieldDescription> variables() const;

    /** Finds the fields in @p points, whose volumes are those of the start; does nothing if off. */
    void initialize(const Material &material, int dimension, MaterialPoints &points);

    /** Advances pressure, dissipation, "viscous work" where the material has it, and tangent of @p
     * n points from @p first on, with strain increments as in MaterialBatch, and volumes and volume
     * ratios at the end of the step. Only if on. */
    void advance(MaterialPoints &points, std::size_t first, unsigned int n,
                 const double *const strain_increment[3], double time_increment) const;

    /** q of every point [M/(L T^2)]; only if on. */
    const double *pressure(const MaterialPoints &points) const
    {
      return points.component(pressure_field, 0);
    }

    /** dq/d|tr D| of every point at the last step [M/(L T)], in compression or not; only if on. */
    const double *tangent(const MaterialPoints &points) const
    {
      return points.component(tangent_field, 0);
    }

    /** The field of the dissipation per initial volume. */
    static const std::string dissipation_name;

  private:
    template <bool heats>
    void advance_points(MaterialPoints &points, std::size_t first, unsigned int n,
                        const double *const strain_increment[3], double time_increment) const;

    double linear = 0., quadratic = 0.;
    double wave_speed = 0., density = 0.; // initial
    double inverse_dimension = 0.;
    unsigned int pressure_field = 0, tangent_field = 0, dissipation_field = 0;
    unsigned int work_field = 0; // "viscous work" of the material
    bool has_work = false;
  };

  /** Σ f V/J over the points of this field, a quantity per initial volume; zero without it. */
  double integral_over_initial_volume(const MaterialPoints &points, const std::string &field);
} // namespace tombolo
