// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/materials/equation_of_state.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/materials/thermal_properties.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Isotropic elasticity, τ̇ = C : D in the rotating frame (eq. 5 without plasticity). Where
   * Young's modulus or Poisson's ratio is a table over the temperature θ, or the material expands,
   * σ = C(θ) : ε_e with the elastic strain rate D - α θ̇ I.
   */
  class LinearElastic : public Material
  {
  public:
    explicit LinearElastic(const Entries &e)
    {
      initial_density = e.number("Density", mandatory, positive(), "M/L^3",
                                 "Density in the initial configuration.");
      young = e.object<TemperatureTable>(
          "Young's modulus", mandatory, "M/(L T^2)",
          "Young's modulus $E$: a number, or pairs `temperature: value` separated by commas.");
      poisson =
          e.object<TemperatureTable>("Poisson's ratio", mandatory, "",
                                     "Poisson's ratio $\\nu$, between -1 and 0.5, both excluded: a "
                                     "number, or pairs `temperature: value` separated by commas.");
      expansion = e.object<TemperatureTable>(
          "Thermal expansion", "0", "1/temperature",
          "The linear strain per increment of the temperature, $\\alpha$: "
          "a number, or pairs `temperature: value` separated by commas.");
      if (e.declares())
        return;
      const Section &section = e.section();
      heat = ThermalProperties::read(section.parent());
      if (!(young.smallest() > 0.))
        section.fail("Young's modulus", young.is_constant()
                                            ? "allowed is a number larger than zero."
                                            : "allowed are values larger than zero.");
      if (!(poisson.smallest() > -1. && poisson.largest() < 0.5))
        section.fail("Poisson's ratio",
                     "allowed is a number between -1 and 0.5, both excluded; for "
                     "nearly incompressible material take for example 0.4999");
      const auto need_heat = [&](const std::string &entry, const std::string &what)
      {
        if (heat == nullptr)
          section.fail(entry,
                       what +
                           " needs the temperature of the material, but its section "
                           "\"Heat\" is missing. Add \"subsection Heat\" with \"Specific heat "
                           "capacity\", \"Conductivity\" and \"Initial temperature\" to " +
                           (section.parent().path().empty()
                                ? "the material"
                                : "section " + in_quotes(section.parent().path())) +
                           ".");
      };
      if (!young.is_constant())
        need_heat("Young's modulus", "a table over the temperature");
      if (!poisson.is_constant())
        need_heat("Poisson's ratio", "a table over the temperature");
      expands = expansion.smallest() != 0. || expansion.largest() != 0.;
      if (!expansion.is_constant())
        need_heat("Thermal expansion", "a table over the temperature");
      else if (expands)
        need_heat("Thermal expansion", "thermal expansion");
      moduli_are_tables = !(young.is_constant() && poisson.is_constant());

      // Between knots of both the moduli are ratios of linear functions, which have no extremum.
      bulk = shear = 0.;
      for (const TemperatureTable *const table : {&young, &poisson})
        for (const double knot : table->temperatures())
        {
          bulk = std::max(bulk, bulk_of(young.value(knot), poisson.value(knot)));
          shear = std::max(shear, shear_of(young.value(knot), poisson.value(knot)));
        }
    }

    /** "thermal work" where a change of the temperature changes the elastic energy. */
    std::vector<FieldDescription> internal_variables() const override
    {
      if (is_thermoelastic())
        return {thermal_work_field()};
      return {};
    }

    double density() const override
    {
      return initial_density;
    }

    /** The largest over all temperatures; with an equation of state that of its initial state. */
    double bulk_modulus() const override
    {
      return pressure ? pressure->bulk_modulus() : bulk;
    }

    /** The largest over all temperatures. */
    double shear_modulus() const override
    {
      return shear;
    }

    void update_stress(MaterialBatch &batch) const override
    {
      advance_stress(batch, is_thermoelastic() ? batch.internal_variables[0] : nullptr);
    }
    void update_stress_and_tangent(MaterialBatch &batch,
                                   const MaterialTangent &tangent) const override
    {
      update_stress(batch);
      std::vector<double> bulk_at(batch.n), shear_at(batch.n);
      elastic_moduli(batch.n, batch.temperature, bulk_at.data(), shear_at.data());
      for (unsigned int i = 0; i < batch.n; ++i)
        set_elastic_tangent(bulk_at[i], shear_at[i], i, tangent);
    }
    void elastic_moduli(const unsigned int n, const double *const temperature,
                        double *const bulk_at, double *const shear_at) const override
    {
      if (!moduli_are_tables)
        return Material::elastic_moduli(n, temperature, bulk_at, shear_at);
      AssertThrow(
          n == 0 || temperature != nullptr,
          dealii::ExcMessage("The moduli of a thermoelastic material need its temperature."));
      evaluate_moduli(n, temperature, bulk_at, shear_at);
    }
    /** With an equation of state that of the deviator: the rest is "pressure work". */
    void elastic_energy_density(const unsigned int n, const double *const stress[6],
                                const double *const temperature,
                                double *const energy_density) const override
    {
      if (pressure)
        return EquationOfState::deviatoric_energy_density(n, stress, shear, energy_density);
      Material::elastic_energy_density(n, stress, temperature, energy_density);
    }

  protected:
    /** update_stress() with "thermal work" at this address, null where there is none. */
    void advance_stress(MaterialBatch &batch, double *const thermal_work) const
    {
      if (moduli_are_tables)
        return advance_thermoelastic<true>(batch, thermal_work);
      if (expands)
        return advance_thermoelastic<false>(batch, thermal_work);

      const double lambda = bulk - 2. / 3. * shear;
      const double twice_shear = 2. * shear;
      const double *const xx = batch.strain_increment[0];
      const double *const yy = batch.strain_increment[1];
      const double *const zz = batch.strain_increment[2];
      for (unsigned int c = 0; c < 6; ++c)
      {
        const double *const strain = batch.strain_increment[c];
        double *const stress = batch.stress[c];
        if (c < 3)
        {
#pragma GCC ivdep
          for (unsigned int i = 0; i < batch.n; ++i)
            stress[i] += lambda * (xx[i] + yy[i] + zz[i]) + twice_shear * strain[i];
        }
        else
        {
#pragma GCC ivdep
          for (unsigned int i = 0; i < batch.n; ++i)
            stress[i] += twice_shear * strain[i];
        }
      }
    }

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
    void evaluate_moduli(const unsigned int n, const double *const temperature,
                         double *const bulk_at, double *const shear_at) const
    {
      // First the tables, each in the array of one modulus.
      young.evaluate(n, temperature, bulk_at);
      poisson.evaluate(n, temperature, shear_at);
#pragma GCC ivdep
      for (unsigned int i = 0; i < n; ++i)
      {
        const double e = bulk_at[i], nu = shear_at[i];
        bulk_at[i] = bulk_of(e, nu);
        shear_at[i] = shear_of(e, nu);
      }
    }
    static FieldDescription thermal_work_field()
    {
      return energy_field("thermal work");
    }

    /** Of Young's modulus and Poisson's ratio; the largest over all temperatures. */
    double elastic_bulk_modulus() const
    {
      return bulk;
    }

    /** What a derived class replaces the mean stress by; null: nothing. */
    std::unique_ptr<const EquationOfState> pressure;

    /** The section "Heat" of the material; null where it sets nothing. */
    std::shared_ptr<const ThermalProperties> heat;

  private:
    static double bulk_of(const double young, const double poisson)
    {
      return young / (3. * (1. - 2. * poisson));
    }

    static double shear_of(const double young, const double poisson)
    {
      return young / (2. * (1. + poisson));
    }

    /** Points whose moduli are evaluated together. */
    static constexpr unsigned int points_per_chunk = 64;

    using ChunkValues = double[points_per_chunk];

    template <bool with_tables>
    void advance_thermoelastic(MaterialBatch &batch, double *const thermal_work) const
    {
      AssertThrow(
          batch.temperature != nullptr && batch.temperature_increment != nullptr,
          dealii::ExcMessage("A thermoelastic material is advanced without a temperature."));
      ChunkValues old_temperature, middle_temperature, alpha, bulk_0, shear_0, bulk_1, shear_1;
      for (unsigned int begin = 0; begin < batch.n; begin += points_per_chunk)
      {
        const unsigned int n = std::min(points_per_chunk, batch.n - begin);
        const double *const temperature = batch.temperature + begin;
        const double *const increment = batch.temperature_increment + begin;
#pragma GCC ivdep
        for (unsigned int i = 0; i < n; ++i)
        {
          old_temperature[i] = temperature[i] - increment[i];
          middle_temperature[i] = temperature[i] - 0.5 * increment[i];
        }
        expansion.evaluate(n, middle_temperature, alpha);
        if constexpr (with_tables)
        {
          evaluate_moduli(n, old_temperature, bulk_0, shear_0);
          evaluate_moduli(n, temperature, bulk_1, shear_1);
        }

        double *stress[6];
        const double *strain[6];
        for (unsigned int c = 0; c < 6; ++c)
        {
          stress[c] = batch.stress[c] + begin;
          strain[c] = batch.strain_increment[c] + begin;
        }
        double *const work = thermal_work + begin;
#pragma GCC ivdep
        for (unsigned int i = 0; i < n; ++i)
        {
          const double k = with_tables ? bulk_1[i] : bulk;
          const double twice_g = 2. * (with_tables ? shear_1[i] : shear);
          const double bulk_factor = with_tables ? bulk_1[i] / bulk_0[i] : 1.;
          const double shear_factor = with_tables ? shear_1[i] / shear_0[i] : 1.;

          const double volumetric = strain[0][i] + strain[1][i] + strain[2][i];
          const double thermal_strain = alpha[i] * increment[i];
          const double old_mean = (stress[0][i] + stress[1][i] + stress[2][i]) * (1. / 3.);
          const double mean = bulk_factor * old_mean + k * (volumetric - 3. * thermal_strain);
          const double third = volumetric * (1. / 3.);
          double product = 0.; // of the old deviator and the new one
          for (unsigned int c = 0; c < 3; ++c)
          {
            const double old_deviator = stress[c][i] - old_mean;
            const double deviator = shear_factor * old_deviator + twice_g * (strain[c][i] - third);
            product += old_deviator * deviator;
            stress[c][i] = mean + deviator;
          }
          for (unsigned int c = 3; c < 6; ++c)
          {
            const double old_stress = stress[c][i];
            const double new_stress = shear_factor * old_stress + twice_g * strain[c][i];
            product += 2. * old_stress * new_stress;
            stress[c][i] = new_stress;
          }

          // With the mean stress of the step as the work of the motion, ½(σ₀ + σ₁) : Δε, what is
          // left of the change of ½ ε_e : C : ε_e is -½(σ₀ + σ₁) : α Δθ I + ½ ε₀ : (C₁ - C₀) : ε₁,
          // exactly.
          double change = -1.5 * thermal_strain * (old_mean + mean);
          if constexpr (with_tables)
            change += 0.5 * ((1. / bulk_0[i] - 1. / bulk_1[i]) * old_mean * mean +
                             0.5 * (1. / shear_0[i] - 1. / shear_1[i]) * product);
          work[i] += change;
        }
      }
    }

    double initial_density;          // [M/L^3]
    double bulk;                     // [M/(L T^2)]
    double shear;                    // [M/(L T^2)]
    bool moduli_are_tables, expands; // then batches need a temperature
    TemperatureTable young, poisson;
    TemperatureTable expansion; // α, of an increment of the temperature [1/temperature]
  };
} // namespace tombolo
