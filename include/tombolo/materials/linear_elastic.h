// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/equation_of_state.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/materials/thermal_properties.h>

#include <memory>

namespace tombolo
{
  /**
   * Isotropic hypoelasticity, σ̇ = C : D in the rotating frame (eq. 5 without plasticity). Where
   * Young's modulus or Poisson's ratio is a table over the temperature θ, or the material expands,
   * σ = C(θ) : ε_e with the elastic strain rate D - α θ̇ I.
   */
  class LinearElastic : public Material
  {
  public:
    explicit LinearElastic(const Entries &e);

    /** "thermal work" where a change of the temperature changes the elastic energy. */
    std::vector<FieldDescription> internal_variables() const override;

    double density() const override
    {
      return initial_density;
    }

    /** The largest over all temperatures; with an equation of state that of its initial state. */
    double bulk_modulus() const override;

    /** The largest over all temperatures. */
    double shear_modulus() const override
    {
      return shear;
    }

    void update_stress(MaterialBatch &batch) const override;
    void update_stress_and_tangent(MaterialBatch &batch,
                                   const MaterialTangent &tangent) const override;
    void elastic_moduli(unsigned int n, const double *temperature, double *bulk,
                        double *shear) const override;
    /** With an equation of state that of the deviator: the rest is "pressure work". */
    void elastic_energy_density(unsigned int n, const double *const stress[6],
                                const double *temperature, double *energy_density) const override;

  protected:
    /** update_stress() with "thermal work" at this place, null where there is none. */
    void advance_stress(MaterialBatch &batch, double *thermal_work) const;

    /** Whether the moduli depend on the temperature. */
    bool has_tables() const
    {
      return moduli_are_tables;
    }

    /** Whether the temperature acts on the stress at all: there is a "thermal work". */
    bool is_thermoelastic() const
    {
      return moduli_are_tables || expands;
    }

    /** Bulk and shear modulus at @p n temperatures, where has_tables(). */
    void evaluate_moduli(unsigned int n, const double *temperature, double *bulk_at,
                         double *shear_at) const;
    static FieldDescription thermal_work_field();

    /** Of Young's modulus and Poisson's ratio; the largest over all temperatures. */
    double elastic_bulk_modulus() const
    {
      return bulk;
    }

    /** What a derived class replaces the mean stress by; null: nothing. */
    std::unique_ptr<const EnergyPressure> pressure;

    /** The section "Heat" of the material; null where it sets nothing. */
    std::shared_ptr<const ThermalProperties> heat;

  private:
    template <bool with_tables>
    void advance_thermoelastic(MaterialBatch &batch, double *thermal_work) const;

    double initial_density;          // [M/L^3]
    double bulk;                     // [M/(L T^2)]
    double shear;                    // [M/(L T^2)]
    bool moduli_are_tables, expands; // then batches need a temperature
    TemperatureTable young, poisson;
    TemperatureTable expansion; // α, of an increment of the temperature [1/temperature]
  };
} // namespace tombolo
