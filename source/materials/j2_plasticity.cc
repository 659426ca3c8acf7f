// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vector_math.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/ductile_damage.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/linear_elastic.h>
#include <tombolo/materials/radial_return_tangent.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace tombolo
{
  namespace
  {
    /** How the plastic work of a material heats its points, by its section. */
    struct AdiabaticHeating
    {
      AdiabaticHeating() = default;
      /** @p heat is the section "Heat" of the material, null without one; @p needs_temperature
       * says whether something depends on the temperature. Throws InputError. */
      AdiabaticHeating(const Entries &e, const ThermalProperties *const heat, const double density,
                       const FlowStress *const flow_stress, const bool needs_temperature)
      {
        taylor_quinney =
            e.number("Taylor-Quinney coefficient", "0", from_to(0., 1.), "1",
                     "The share $\\eta$ of the plastic work that heats the material, from 0 to 1.");
        if (heat != nullptr)
        {
          for (const char *const entry : {"Specific heat capacity", "Initial temperature"})
            e.refuse(
                e.is_set(entry), entry,
                "the section \"Heat\" of the material says it already; allowed is one of both.");
          const double start = heat->initial_temperature();
          per_work = taylor_quinney / (density * heat->capacity().value(start));
          flow_stress->check_initial_temperature(start);
          return;
        }
        if (e.when(taylor_quinney > 0.))
        {
          const double capacity = e.number(
              "Specific heat capacity", mandatory, positive(), "L^2/(T^2 temperature)",
              "$c$ per mass, where plastic work heats and the material has no section \"Heat\".");
          if (!e.declares())
            per_work = taylor_quinney / (density * capacity);
        }
        is_kept = per_work > 0. || needs_temperature;
        if (!e.when(is_kept))
          return;
        initial_temperature = e.number(
            "Initial temperature", mandatory, any_number(), "",
            "The temperature at the start, where plastic work heats or the flow stress or the "
            "damage depends on the temperature, and the material has no section \"Heat\".");
        if (flow_stress != nullptr)
          flow_stress->check_initial_temperature(initial_temperature);
      }

      double taylor_quinney = 0; ///< η
      double per_work = 0;       ///< η/(ρ₀ c): temperature per plastic work per initial volume
      double initial_temperature = 0; ///< where points keep it
      bool is_kept = false;           ///< points keep a temperature of their own
    };

    /** Points treated together, of which those that yield are packed for the corrector. */
    constexpr unsigned int chunk_size = 64;

    using Values = double[chunk_size];

    enum Variable : unsigned int
    {
      effective_plastic_strain,
      plastic_work,
      own_temperature,                // of a material without "Heat"
      yield_stress,                   // of a material without "Heat" that softens by heating
      thermal_work = own_temperature, // of a material with it
    };

    /** The points of a chunk in groups of n_lanes, packed: those with a point that yields. */
    struct Chunk
    {
      alignas(64) Values trial_stress, flow, slope;          // of the whole chunk; later packed
      alignas(64) Values trial, old_strain, old_temperature; // packed, as all below
      alignas(64) Values old_power;                          // old stress : flow direction
      alignas(64) Values increment, newton, lower,
          upper; // Δp, its next value, bounds of it (upper: 0 where it is found)
      alignas(64) Values strain, new_temperature, temperature_change;
      // With tables: 3 G at the end of the step, 1/G at its start less 1/G at its end.
      alignas(64) Values threefold_shear, compliance_decrease;
      unsigned int group[chunk_size / n_lanes]; // first point of each packed group
      unsigned int n;                           // packed points

      /** Of the increments: heated by the mean of the plastic power at both ends of the step. */
      template <bool with_tables>
      void update_temperature(const double heating, const double constant_threefold_shear)
      {
        const unsigned int n_points = n;
#pragma GCC ivdep
        for (unsigned int k = 0; k < n_points; ++k)
        {
          const double x = increment[k];
          const double shear = with_tables ? threefold_shear[k] : constant_threefold_shear;
          const double sum = old_power[k] + trial[k];
          new_temperature[k] = old_temperature[k] + heating * (0.5 * (sum - shear * x) * x);
          temperature_change[k] = heating * (0.5 * sum - shear * x);
        }
      }
      void update_strain()
      {
        const unsigned int n_points = n;
#pragma GCC ivdep
        for (unsigned int k = 0; k < n_points; ++k)
          strain[k] = old_strain[k] + increment[k];
      }

      /** How many points are open, and how many Newton's method moves out of the bounds. */
      struct Progress
      {
        long long n_open, n_outside;
      };
      /** By the residuals of the increments; sets the next values of Newton's method. */
      template <bool with_tables>
      Progress narrow_bounds(const double constant_threefold_shear)
      {
        // The error after the last step is of the order of the square of the tolerance. A point
        // that is done stays as it is, so that it does not depend on its neighbours in the chunk.
        constexpr double tolerance = 1e-6;
        const unsigned int n_points = n;
        long long n_open = 0, n_outside = 0;
#pragma GCC ivdep
        for (unsigned int k = 0; k < n_points; ++k)
        {
          const double x = increment[k];
          const double shear = with_tables ? threefold_shear[k] : constant_threefold_shear;
          const double residual = trial[k] - shear * x - flow[k];
          const bool is_below = residual > 0.;
          const double new_lower = is_below ? x : lower[k];
          const double new_upper = is_below ? upper[k] : x;
          const double step = residual / (shear + slope[k]);
          const bool was_open = upper[k] > 0.;
          const double next = was_open ? x + step : x;
          const bool is_inside = (!was_open) | ((next >= new_lower) & (next <= new_upper));
          const bool is_open =
              was_open & !(is_inside & (std::abs(residual) < tolerance * trial[k]));
          n_open += is_open ? 1 : 0;
          n_outside += is_inside ? 0 : 1;
          newton[k] = next;
          lower[k] = new_lower;
          upper[k] = is_open ? new_upper : 0.;
        }
        return {n_open, n_outside};
      }
      /** Sets the next values of Newton's method, and others where these are outside of the
       * bounds, or at all points that are not yet found where @p narrows.
       */
      void set_next_values(const bool narrows)
      {
        const unsigned int n_points = n;
        for (unsigned int k = 0; k < n_points; ++k)
        {
          const double x = increment[k], from = lower[k], to = upper[k], next = newton[k];
          // A step below the bounds comes from logarithms or powers of a Δp much smaller than
          // assumed, and is taken in ln Δp instead.
          double exponent = (next - x) / x;
          exponent = exponent > -50. ? exponent : -50.;
          exponent = exponent < -0.7 ? exponent : -0.7;
          const double fallback = from > 0. ? 0.5 * (from + to) : x * std::exp(exponent);
          const bool is_inside = to == 0. || (!narrows && next >= from && next <= to);
          increment[k] = is_inside ? next : fallback;
        }
      }
    };
  } // namespace

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
   * and logarithms are taken where the material flows. Where the section requests it, the pressure
   * is that of an equation of state, and points have a damage.
   */
  class J2Plasticity : public LinearElastic
  {
  public:
    explicit J2Plasticity(const Entries &e) : LinearElastic(e)
    {
      flow_stress =
          e.plugin<FlowStress>("Flow stress", mandatory, "The stress at which the material flows.");
      if (!e.declares())
        damage = DuctileDamage::create(e);
      const bool needs_temperature = (flow_stress && flow_stress->depends_on_temperature()) ||
                                     (damage && damage->depends_on_temperature());
      adiabatic = AdiabaticHeating(e, heat.get(), density(), flow_stress.get(), needs_temperature);
      e.plugins<FlowStress>();
      if (e.declares())
      {
        EquationOfState::create(e);
        DuctileDamage::create(e);
        return;
      }
      has_temperature = adiabatic.is_kept || (heat != nullptr && needs_temperature);
      keeps_yield_stress = heat == nullptr && flow_stress->depends_on_temperature();
      first_further_field =
          static_cast<unsigned int>(internal_variables().size()) - (damage ? 1 : 0);
      pressure = EquationOfState::create(e);
    }
    /** "effective plastic strain", "plastic work" and, where needed, "temperature", "yield stress"
     * (without "Heat") and "thermal work"; then those of EquationOfState and DuctileDamage. */
    std::vector<FieldDescription> internal_variables() const override
    {
      std::vector<FieldDescription> fields = {
          {"effective plastic strain", "1", FieldLocation::material_point, 1, true},
          energy_field("plastic work")};
      if (adiabatic.is_kept)
        fields.push_back({"temperature", "temperature", FieldLocation::material_point, 1, true,
                          adiabatic.initial_temperature});
      if (keeps_yield_stress)
        fields.push_back({"yield stress", "M/(L T^2)", FieldLocation::material_point, 1, true,
                          slow_yield_stress(0., adiabatic.initial_temperature)});
      if (is_thermoelastic())
        fields.push_back(thermal_work_field());
      if (pressure)
        for (const FieldDescription &field : pressure->fields())
          fields.push_back(field);
      if (damage)
        fields.push_back(DuctileDamage::field());
      return fields;
    }
    /** The Taylor-Quinney coefficient η where the material has a section "Heat". */
    double plastic_heat_fraction() const override
    {
      return heat != nullptr ? adiabatic.taylor_quinney : 0.;
    }
    void update_stress(MaterialBatch &batch) const override
    {
      AssertThrow(!has_temperature || adiabatic.is_kept || batch.temperature != nullptr,
                  ExcMessage("A material with a section Heat is advanced without a temperature."));
      advance_stress(batch, is_thermoelastic() ? batch.internal_variables[thermal_work] : nullptr);
      const auto advance =
          has_tables() ? &J2Plasticity::advance_chunk<true> : &J2Plasticity::advance_chunk<false>;
      for (unsigned int begin = 0; begin < batch.n; begin += chunk_size)
        (this->*advance)(batch, begin, std::min(chunk_size, batch.n - begin));
    }
    void update_stress_and_tangent(MaterialBatch &batch,
                                   const MaterialTangent &tangent) const override
    {
      AlignedVector<double> bulk(batch.n), shear(batch.n);
      elastic_moduli(batch.n, batch.temperature, bulk.begin(), shear.begin());
      RadialReturnTangent step_tangent(batch, temperature_of(batch), adiabatic.per_work);
      update_stress(batch);
      step_tangent.find(batch, *flow_stress, bulk.begin(), shear.begin(), tangent);
    }
    double slow_yield_stress(const double plastic_strain, const double temperature) const override
    {
      alignas(64) double at[2][n_lanes], yield[n_lanes], slope[n_lanes];
      store_lanes(Lanes(plastic_strain), at[0]);
      store_lanes(Lanes(temperature), at[1]);
      evaluate_yield_stress(n_lanes, at[0], has_temperature ? at[1] : nullptr, yield, slope);
      return yield[0];
    }
    double melts_at() const override
    {
      return flow_stress->melts_at();
    }
    double cost_per_point() const override
    {
      return LinearElastic::cost_per_point() + flow_stress->cost_per_point();
    }

  private:
    /** return_chunk(), then pressure and damage where they are on. */
    template <bool with_tables>
    void advance_chunk(const MaterialBatch &batch, const unsigned int begin,
                       const unsigned int n) const
    {
      if (!damage && !pressure)
        return return_chunk<with_tables>(batch, begin, n);
      const double *const strain = batch.internal_variables[effective_plastic_strain] + begin;
      alignas(64) Values old_strain;
      std::copy_n(strain, n, old_strain);
      return_chunk<with_tables>(batch, begin, n);
      if (pressure)
        pressure->advance(batch, begin, n, first_further_field,
                          batch.internal_variables[plastic_work] + begin, elastic_bulk_modulus());
      if (damage)
        damage->advance(batch, begin, n, old_strain, strain,
                        has_temperature ? temperature_of(batch) + begin : nullptr,
                        batch.internal_variables.back() + begin);
    }
    /** The temperature of the flow stress at the start of the step; null if it needs none. */
    const double *temperature_of(const MaterialBatch &batch) const
    {
      if (!has_temperature)
        return nullptr;
      return adiabatic.is_kept ? batch.internal_variables[own_temperature] : batch.temperature;
    }
    void evaluate_yield_stress(const unsigned int n, const double *const plastic_strain,
                               const double *const temperature, double *const yield_stress,
                               double *const slope) const
    {
      alignas(64) static constexpr Values none = {};
      flow_stress->evaluate({n, 0., plastic_strain, none, temperature, none, yield_stress, slope});
    }
    template <bool with_tables>
    void return_chunk(const MaterialBatch &batch, const unsigned int begin,
                      const unsigned int n) const
    {
      Chunk chunk;
      const double *stress[6];
      for (unsigned int c = 0; c < 6; ++c)
        stress[c] = batch.stress[c] + begin;
#pragma GCC ivdep
      for (unsigned int i = 0; i < n; ++i)
      {
        const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) * (1. / 3.);
        const double xx = stress[0][i] - mean, yy = stress[1][i] - mean, zz = stress[2][i] - mean;
        const double shears =
            stress[3][i] * stress[3][i] + stress[4][i] * stress[4][i] + stress[5][i] * stress[5][i];
        chunk.trial_stress[i] = std::sqrt(1.5 * (xx * xx + yy * yy + zz * zz) + 3. * shears);
        chunk.increment[i] = 0.;
      }

      const double *yield = chunk.flow;
      if (keeps_yield_stress)
        yield = batch.internal_variables[yield_stress] + begin;
      else
        evaluate_yield_stress(n, batch.internal_variables[effective_plastic_strain] + begin,
                              has_temperature ? temperature_of(batch) + begin : nullptr, chunk.flow,
                              chunk.slope);

      chunk.n = gather_yielding<with_tables>(batch, yield, begin, n, chunk);
      if (chunk.n == 0)
        return;
      solve<with_tables>(batch.time_increment > 0. ? 1. / batch.time_increment : 0., chunk);
      scatter<with_tables>(batch, begin, chunk);
      if (keeps_yield_stress)
        keep_yield_stress(batch, begin, chunk);
    }
    template <bool with_tables>
    unsigned int gather_yielding(const MaterialBatch &batch, const double *const yield,
                                 const unsigned int begin, const unsigned int n, Chunk &chunk) const
    {
      const double *const old_temperature = temperature_of(batch);
      Lanes shear = shear_modulus();
      Lanes old_shear = shear;
      Lanes inverse_threefold_shear = 1. / (3. * shear);
      unsigned int n_packed = 0;
      for (unsigned int first = 0; first < n; first += n_lanes)
      {
        if (none_of(load_lanes(chunk.trial_stress + first) > load_lanes(yield + first)))
          continue;
        chunk.group[n_packed / n_lanes] = first;
        const unsigned int from = begin + first;
        if constexpr (with_tables)
        {
          evaluate_shear(batch, from, old_shear, shear);
          inverse_threefold_shear = 1. / (3. * shear);
          store_lanes(3. * shear, chunk.threefold_shear + n_packed);
          store_lanes(1. / old_shear - 1. / shear, chunk.compliance_decrease + n_packed);
        }
        const Lanes twice_shear = 2. * shear;
        Lanes s[6], e[6];
        for (unsigned int c = 0; c < 6; ++c)
        {
          s[c] = load_lanes(batch.stress[c] + from);
          e[c] = load_lanes(batch.strain_increment[c] + from);
        }
        const Lanes mean = (s[0] + s[1] + s[2]) * (1. / 3.);
        const Lanes volumetric = e[0] + e[1] + e[2];
        const Lanes third = volumetric * (1. / 3.);
        Lanes along = 0., squared = 0.; // s : Δe and Δe : Δe of the deviators
        for (unsigned int c = 0; c < 6; ++c)
        {
          const Lanes deviator = c < 3 ? e[c] - third : e[c];
          const Lanes weighted = (c < 3 ? 1. : 2.) * deviator;
          along += (c < 3 ? s[c] - mean : s[c]) * weighted;
          squared += deviator * weighted;
        }
        const Lanes trial = load_lanes(chunk.trial_stress + first);
        const Lanes flow = load_lanes(yield + first);
        const auto yields = trial > flow;
        // Lanes that do not yield are held at no increment by bounds of zero.
        Lanes excess = 0., old_power = 0., upper = 0.;
        where(yields, excess) = (trial - flow) * inverse_threefold_shear;
        where(yields, old_power) = trial - 1.5 * twice_shear * along / trial;
        if constexpr (with_tables)
          old_power *= old_shear / shear;
        where(yields, upper) = trial * inverse_threefold_shear;
        // A point that keeps flowing takes about the whole strain increment as plastic; one that
        // relaxes takes something below the excess.
        alignas(64) double root[n_lanes];
        store_lanes(2. / 3. * squared, root);
        for (double &value : root)
          value = std::sqrt(value);
        const Lanes effective = load_lanes(root);
        Lanes guess = excess;
        where(effective < excess && effective > 0.01 * excess, guess) = effective;

        store_lanes(trial, chunk.trial + n_packed);
        store_lanes(load_lanes(batch.internal_variables[effective_plastic_strain] + from),
                    chunk.old_strain + n_packed);
        store_lanes(old_power, chunk.old_power + n_packed);
        store_lanes(Lanes(0.), chunk.lower + n_packed);
        store_lanes(upper, chunk.upper + n_packed);
        store_lanes(guess, chunk.increment + n_packed);
        if (has_temperature)
          store_lanes(load_lanes(old_temperature + from), chunk.old_temperature + n_packed);
        n_packed += n_lanes;
      }
      return n_packed;
    }
    void evaluate_shear(const MaterialBatch &batch, const unsigned int from, Lanes &old_shear,
                        Lanes &shear) const
    {
      const Lanes temperature = load_lanes(batch.temperature + from);
      alignas(64) double at[2][n_lanes], bulk_at[2][n_lanes], shear_at[2][n_lanes];
      store_lanes(temperature - load_lanes(batch.temperature_increment + from), at[0]);
      store_lanes(temperature, at[1]);
      for (unsigned int k = 0; k < 2; ++k)
        evaluate_moduli(n_lanes, at[k], bulk_at[k], shear_at[k]);
      old_shear = load_lanes(shear_at[0]);
      shear = load_lanes(shear_at[1]);
    }
    template <bool with_tables>
    void solve(const double inverse_time_increment, Chunk &chunk) const
    {
      const double constant_threefold_shear = 3. * shear_modulus();
      const FlowStressBatch end{chunk.n,
                                inverse_time_increment,
                                chunk.strain,
                                chunk.increment,
                                has_temperature ? chunk.new_temperature : nullptr,
                                has_temperature ? chunk.temperature_change : nullptr,
                                chunk.flow,
                                chunk.slope};

      // Newton's method for trial - 3 G Δp - σ_y(Δp) = 0, which is positive at Δp = 0 and at most
      // zero where no deviatoric stress is left: every evaluation narrows these bounds.
      constexpr unsigned int max_iterations = 80;
      for (unsigned int iteration = 0; iteration < max_iterations; ++iteration)
      {
        if (has_temperature)
          chunk.update_temperature<with_tables>(adiabatic.per_work, constant_threefold_shear);
        chunk.update_strain();
        flow_stress->evaluate(end);
        const Chunk::Progress progress = chunk.narrow_bounds<with_tables>(constant_threefold_shear);
        // Across a kink of the flow stress, Newton's method can go to and fro between both bounds.
        const bool narrows = iteration >= 8 && iteration % 2 == 0;
        if (progress.n_outside == 0 && !narrows)
          std::copy_n(chunk.newton, chunk.n, chunk.increment);
        else
          chunk.set_next_values(narrows);
        if (progress.n_open == 0)
          return;
      }
    }
    template <bool with_tables>
    void scatter(const MaterialBatch &batch, const unsigned int begin, Chunk &chunk) const
    {
      const Lanes constant_threefold_shear = 3. * shear_modulus();
      for (unsigned int packed = 0; packed < chunk.n; packed += n_lanes)
      {
        const unsigned int from = begin + chunk.group[packed / n_lanes];
        const Lanes increment = load_lanes(chunk.increment + packed);
        const Lanes trial = load_lanes(chunk.trial + packed);
        const Lanes threefold_shear =
            with_tables ? load_lanes(chunk.threefold_shear + packed) : constant_threefold_shear;
        const Lanes flow = max(trial - threefold_shear * increment, Lanes(0.));
        Lanes factor = flow / trial;
        where(!(trial > 0.), factor) = 1.;

        Lanes stress[6];
        for (unsigned int c = 0; c < 6; ++c)
          stress[c] = load_lanes(batch.stress[c] + from);
        const Lanes mean = (stress[0] + stress[1] + stress[2]) * (1. / 3.);
        const LaneMask flows = increment > 0.; // the others keep their digits
        for (unsigned int c = 0; c < 6; ++c)
        {
          where(flows, stress[c]) = c < 3 ? mean + factor * (stress[c] - mean) : factor * stress[c];
          store_lanes(stress[c], batch.stress[c] + from);
        }

        const Lanes old_power = load_lanes(chunk.old_power + packed);
        const Lanes work = 0.5 * (old_power + flow) * increment;
        double *const strain = batch.internal_variables[effective_plastic_strain] + from;
        double *const total_work = batch.internal_variables[plastic_work] + from;
        const Lanes new_strain = load_lanes(strain) + increment;
        store_lanes(new_strain, strain);
        store_lanes(load_lanes(total_work) + work, total_work);
        if (adiabatic.is_kept)
        {
          const Lanes temperature =
              load_lanes(chunk.old_temperature + packed) + adiabatic.per_work * work;
          store_lanes(temperature, batch.internal_variables[own_temperature] + from);
          store_lanes(temperature, chunk.new_temperature + packed);
          store_lanes(new_strain, chunk.strain + packed);
        }
        if constexpr (with_tables)
        {
          // The elastic update took the work of the change of G with the trial stress as the new
          // one: ¼(1/G₀ - 1/G₁) s₀ : s₁, where s₀ : s_trial = ⅔ trial old_power.
          double *const given = batch.internal_variables[thermal_work] + from;
          store_lanes(load_lanes(given) + load_lanes(chunk.compliance_decrease + packed) *
                                              (1. / 6.) * old_power * (flow - trial),
                      given);
        }
      }
    }
    void keep_yield_stress(const MaterialBatch &batch, const unsigned int begin, Chunk &chunk) const
    {
      evaluate_yield_stress(chunk.n, chunk.strain, chunk.new_temperature, chunk.flow, chunk.slope);
      double *const yield = batch.internal_variables[yield_stress] + begin;
      for (unsigned int packed = 0; packed < chunk.n; packed += n_lanes)
        store_lanes(load_lanes(chunk.flow + packed), yield + chunk.group[packed / n_lanes]);
    }

    std::unique_ptr<const FlowStress> flow_stress;
    std::unique_ptr<const DuctileDamage> damage; // null: none
    unsigned int first_further_field = 0;        // those of pressure, then that of damage
    bool has_temperature = false; ///< the flow stress is evaluated with a temperature
    bool keeps_yield_stress = false;
    AdiabaticHeating adiabatic;
  };

  TOMBOLO_REGISTER(
      Material, J2Plasticity, "j2 plasticity",
      "elastic, with plastic flow at a von Mises stress given by a flow stress, heated "
      "by the plastic work")
} // namespace tombolo
