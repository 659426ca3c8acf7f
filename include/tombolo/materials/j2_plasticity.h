// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/damage_growth.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/linear_elastic.h>

#include <memory>

namespace tombolo
{
  /**
   * Elasticity in rate form as LinearElastic, with J2 plasticity: radial return to the flow stress
   * at the end of the step, σ_e = σ_y(ε_p, ε̇_p, T), solved for the plastic increment of the step.
   * Where the flow stress depends on the temperature, or a part of the plastic work heats
   * (Taylor-Quinney), points have a temperature that rises adiabatically, η/(ρ₀ c) times the
   * plastic work per initial volume. A material with a section "Heat" keeps no temperature: that of
   * the batch holds all heating up to the last step, to which the flow stress adds that of the step
   * in progress, with c at the initial temperature. Where points have a temperature
   * that the flow stress depends on, they keep their "yield stress" too, the flow stress of a slow
   * test at their strain and temperature: all three change with plastic flow only, so that powers
   * and logarithms are taken where the material flows. Where the section asks for it, the pressure
   * is that of an equation of state, and points have a damage.
   */
  class J2Plasticity : public LinearElastic
  {
  public:
    explicit J2Plasticity(const Entries &e);
    /** "effective plastic strain", "plastic work" and, where needed, "temperature" and "yield
     * stress" (only without a section "Heat") and "thermal work"; then those of EnergyPressure and
     * DamageGrowth. */
    std::vector<FieldDescription> internal_variables() const override;
    /** The Taylor-Quinney coefficient η where the material has a section "Heat". */
    double plastic_heat_fraction() const override;
    void update_stress(MaterialBatch &batch) const override;
    void update_stress_and_tangent(MaterialBatch &batch,
                                   const MaterialTangent &tangent) const override;
    double slow_yield_stress(double plastic_strain, double temperature) const override;
    double cost_per_point() const override
    {
      return LinearElastic::cost_per_point() + flow_stress->cost_per_point();
    }

  private:
    struct Chunk;

    /** return_chunk(), then pressure and damage where they are on. */
    template <bool with_tables>
    void advance_chunk(const MaterialBatch &batch, unsigned int begin, unsigned int n) const;
    /** What the flow stress sees at the start of the step; null if it needs none. */
    const double *temperature_of(const MaterialBatch &batch) const;
    void evaluate_yield_stress(unsigned int n, const double *plastic_strain,
                               const double *temperature, double *yield_stress,
                               double *slope) const;
    template <bool with_tables>
    void return_chunk(const MaterialBatch &batch, unsigned int begin, unsigned int n) const;
    template <bool with_tables>
    unsigned int gather_yielding(const MaterialBatch &batch, const double *yield,
                                 unsigned int begin, unsigned int n, Chunk &chunk) const;
    void evaluate_shear(const MaterialBatch &batch, unsigned int from, Lanes &old_shear,
                        Lanes &shear) const;
    template <bool with_tables>
    void solve(double inverse_time_increment, Chunk &chunk) const;
    template <bool with_tables>
    void scatter(const MaterialBatch &batch, unsigned int begin, Chunk &chunk) const;
    void keep_yield_stress(const MaterialBatch &batch, unsigned int begin, Chunk &chunk) const;

    std::unique_ptr<const FlowStress> flow_stress;
    std::unique_ptr<const DamageGrowth> damage; // null: none
    unsigned int first_further_field = 0;       // those of pressure, then that of damage
    bool sees_temperature = false;              ///< the flow stress is evaluated with a temperature
    bool keeps_temperature = false;             ///< as an internal variable
    bool keeps_yield_stress = false;
    double taylor_quinney = 0; ///< η
    double initial_temperature = 0;
    double heating = 0; ///< η/(ρ₀ c): temperature per plastic work per initial volume
  };
} // namespace tombolo
