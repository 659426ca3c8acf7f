// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/linear_elastic.h>

#include <array>
#include <memory>
#include <vector>

namespace tombolo
{
  namespace
  {
    using Tensor = std::array<Lanes, 6>;

    Lanes contract(const Tensor &a, const Tensor &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] +
             2. * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
    }

    Lanes von_mises(const Tensor &deviator)
    {
      return square_root(1.5 * contract(deviator, deviator));
    }

    Tensor load(const std::array<double *, 6> &component)
    {
      Tensor result;
      for (unsigned int c = 0; c < 6; ++c)
        result[c] = load_lanes(component[c]);
      return result;
    }

    /** A term of the back stress: its modulus C [M/(L T^2)] and its rate of recovery γ. */
    struct BackStress
    {
      double modulus, recovery;
    };

    /** The return of n_lanes points to the yield surface, and what it makes of the state. */
    struct Return
    {
      Tensor trial;                                           ///< deviator of the trial stress
      std::vector<Tensor> old_back;                           ///< α_k at the start of the step
      Lanes shear;                                            ///< G at its end [M/(L T^2)]
      alignas(64) double increment[n_lanes], strain[n_lanes]; ///< Δp and p at its end
      alignas(64) double flow[n_lanes], slope[n_lanes];       ///< σ_y and dσ_y/dΔp there
      // By set() of Δp:
      Tensor relative; ///< A = s_trial - Σ w_k α_k, with w_k = 1/(1 + γ_k Δp)
      Tensor change;   ///< dA/dΔp
      Lanes effective; ///< |A|, its von Mises stress
      Lanes modulus;   ///< Σ w_k C_k
      Lanes hardening; ///< d(Δp Σ w_k C_k)/dΔp - N : dA/dΔp

      void set(const std::vector<BackStress> &terms)
      {
        const Lanes x = load_lanes(increment);
        relative = trial;
        change.fill(0.);
        modulus = hardening = 0.;
        for (std::size_t k = 0; k < terms.size(); ++k)
        {
          const Lanes w = 1. / (1. + terms[k].recovery * x);
          modulus += w * terms[k].modulus;
          hardening += w * w * terms[k].modulus;
          for (unsigned int c = 0; c < 6; ++c)
          {
            relative[c] -= w * old_back[k][c];
            change[c] += terms[k].recovery * w * w * old_back[k][c];
          }
        }
        effective = von_mises(relative);
        hardening -= contract(direction(), change);
      }
      /** N, the direction of plastic flow: zero where there is no stress to flow by. */
      Tensor direction() const
      {
        Lanes factor = 1.5 / effective;
        where(!(effective > 0.), factor) = 0.;
        Tensor result;
        for (unsigned int c = 0; c < 6; ++c)
          result[c] = factor * relative[c];
        return result;
      }
    };
  } // namespace

  /**
   * Elasticity as LinearElastic, with J2 plasticity around a back stress α = Σ α_k, by which metals
   * yield earlier when they are loaded backwards (Bauschinger), as Armstrong, Frederick and
   * Chaboche describe it:
   *
   * @verbatim
   *   |s - α| = σ_y(p, dp/dt, θ),   dα_k = ⅔ C_k dε_p - γ_k α_k dp
   * @endverbatim
   *
   * with the von Mises stress | | and the effective plastic strain p. The step is implicit: with
   * w_k = 1/(1 + γ_k Δp) and A = s_trial - Σ w_k α_k, plastic flow goes along N = 3/2 A/|A|, and Δp
   * follows from |A| - Δp (3G + Σ w_k C_k) = σ_y. What the α_k store, Σ 3/(4 C_k) α_k : α_k, is
   * "pressure work" of the point; the rest of the plastic work is lost, and heats.
   */
  class Chaboche : public LinearElastic
  {
  public:
    explicit Chaboche(const Entries &e) : LinearElastic(e)
    {
      flow_stress = e.plugin<FlowStress>(
          "Flow stress", mandatory,
          "The radius of the yield surface around the back stress, which may grow or shrink.");
      taylor_quinney =
          e.number("Taylor-Quinney coefficient", "0", from_to(0., 1.), "1",
                   "The share of the lost plastic work that heats in scenes with heat.");
      e.text("Back stress moduli", mandatory, "M/(L T^2)",
             "The moduli $C_k$ of the terms of the back stress, separated by commas. That of one "
             "term without recovery is the slope of the stress over the plastic strain.");
      e.text(
          "Recovery rates", "0", "1",
          "The rates $\\gamma_k$ of these terms, as many: a term ends at $C_k/\\gamma_k$; with 0 "
          "it grows without end.");
      e.plugins<FlowStress>();
      if (e.declares())
        return;
      const std::vector<double> moduli = e.section().get_doubles("Back stress moduli"),
                                rates = e.section().get_doubles("Recovery rates");
      e.refuse(moduli.empty(), "Back stress moduli", "allowed is at least one modulus.");
      e.refuse(rates.size() != moduli.size(), "Recovery rates",
               "allowed are as many numbers as \"Back stress moduli\" has: " +
                   std::to_string(moduli.size()) + ".");
      for (std::size_t k = 0; k < moduli.size(); ++k)
      {
        e.refuse(!(moduli[k] > 0.), "Back stress moduli",
                 "allowed are numbers larger than zero; number " + std::to_string(k + 1) +
                     " is not.");
        e.refuse(!(rates[k] >= 0.), "Recovery rates",
                 "allowed are zero and positive numbers; number " + std::to_string(k + 1) +
                     " is none of them.");
        terms.push_back({moduli[k], rates[k]});
      }
      e.refuse(flow_stress->depends_on_temperature() && heat == nullptr, "Flow stress",
               "it depends on the temperature, and the material has no section \"Heat\"; allowed "
               "is one that does not, or such a section.");
      if (heat != nullptr)
        flow_stress->check_initial_temperature(heat->initial_temperature());
    }

    std::vector<FieldDescription> internal_variables() const override
    {
      std::vector<FieldDescription> fields(3 + terms.size());
      fields[effective_plastic_strain] = {"effective plastic strain", "1",
                                          FieldLocation::material_point, 1, true};
      fields[plastic_work] = energy_field("plastic work");
      fields[stored_work] = energy_field("pressure work");
      for (std::size_t k = 0; k < terms.size(); ++k)
      {
        FieldDescription &field = fields[3 + k];
        field = {"back stress " + std::to_string(k + 1), "M/(L T^2)", FieldLocation::material_point,
                 6, true};
        field.turns = true;
      }
      if (is_thermoelastic())
        fields.push_back(thermal_work_field());
      return fields;
    }

    double plastic_heat_fraction() const override
    {
      return heat != nullptr ? taylor_quinney : 0.;
    }

    double slow_yield_stress(const double plastic_strain, const double temperature) const override
    {
      Return single;
      store_lanes(Lanes(plastic_strain), single.strain);
      evaluate_flow(single, Lanes(0.), temperature, 0.);
      return single.flow[0];
    }

    double melts_at() const override
    {
      return flow_stress->melts_at();
    }

    double cost_per_point() const override
    {
      return LinearElastic::cost_per_point() + flow_stress->cost_per_point() +
             2. * double(terms.size());
    }

    void update_stress(MaterialBatch &batch) const override
    {
      update(batch, nullptr);
    }

    void update_stress_and_tangent(MaterialBatch &batch,
                                   const MaterialTangent &tangent) const override
    {
      update(batch, &tangent);
    }

  private:
    enum Variable : unsigned int
    {
      effective_plastic_strain,
      plastic_work,
      stored_work,
      first_back_stress
    };

    /** @p tangent is set, too, where it is not null. */
    void update(MaterialBatch &batch, const MaterialTangent *const tangent) const
    {
      double *const thermal_work = is_thermoelastic() ? batch.internal_variables.back() : nullptr;
      advance_stress(batch, thermal_work);
      alignas(64) double bulk[n_lanes], shear[n_lanes], old_bulk[n_lanes], old_shear[n_lanes];
      Return points;
      points.old_back.resize(terms.size());
      for (unsigned int i = 0; i < batch.n; i += n_lanes)
      {
        const double *const temperature = batch.temperature ? batch.temperature + i : nullptr;
        elastic_moduli(n_lanes, temperature, bulk, shear);
        if (tangent)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            set_elastic_tangent(bulk[lane], shear[lane], i + lane, *tangent);
        points.shear = load_lanes(shear);
        if (!return_points(batch, i, points))
          continue;
        Lanes old = points.shear;
        if (has_tables())
        {
          alignas(64) double before[n_lanes];
          store_lanes(load_lanes(temperature) - load_lanes(batch.temperature_increment + i),
                      before);
          elastic_moduli(n_lanes, before, old_bulk, old_shear);
          old = load_lanes(old_shear);
        }
        keep(batch, i, points, old, thermal_work);
        if (tangent)
          soften(i, points, *tangent);
      }
    }

    std::array<double *, 6> back_stress(const MaterialBatch &batch, const std::size_t k,
                                        const unsigned int i) const
    {
      std::array<double *, 6> result;
      for (unsigned int c = 0; c < 6; ++c)
        result[c] = batch.internal_variables[first_back_stress + 6 * k + c] + i;
      return result;
    }

    void evaluate_flow(Return &points, const Lanes &increment, const Lanes &temperature,
                       const double inverse_time_increment) const
    {
      alignas(64) double theta[n_lanes], no_change[n_lanes] = {};
      store_lanes(temperature, theta);
      store_lanes(increment, points.increment);
      const bool has_temperature = flow_stress->depends_on_temperature();
      flow_stress->evaluate({n_lanes, inverse_time_increment, points.strain, points.increment,
                             has_temperature ? theta : nullptr,
                             has_temperature ? no_change : nullptr, points.flow, points.slope});
    }

    /** Finds the plastic increments of the points from @p i on; false where none flows. */
    bool return_points(const MaterialBatch &batch, const unsigned int i, Return &points) const
    {
      const Lanes temperature = batch.temperature ? load_lanes(batch.temperature + i) : Lanes(0.);
      const Lanes old_strain = load_lanes(batch.internal_variables[effective_plastic_strain] + i);
      for (unsigned int c = 0; c < 6; ++c)
        points.trial[c] = load_lanes(batch.stress[c] + i);
      const Lanes mean = (points.trial[0] + points.trial[1] + points.trial[2]) * (1. / 3.);
      for (unsigned int c = 0; c < 3; ++c)
        points.trial[c] -= mean;
      Lanes largest = von_mises(points.trial);
      for (std::size_t k = 0; k < terms.size(); ++k)
      {
        points.old_back[k] = load(back_stress(batch, k, i));
        largest += von_mises(points.old_back[k]);
      }
      store_lanes(old_strain, points.strain);
      evaluate_flow(points, Lanes(0.), temperature, 0.);
      points.set(terms);
      const LaneMask flows = points.effective > load_lanes(points.flow);
      if (none_of(flows))
        return false;

      // The residual falls with Δp: a term of the back stress is at most C/γ.
      constexpr unsigned int max_iterations = 80;
      constexpr double tolerance = 1e-7; // the error after the last step is of its square
      const double rate = batch.time_increment > 0. ? 1. / batch.time_increment : 0.;
      const Lanes threefold_shear = 3. * points.shear;
      const Lanes scale = points.effective;
      Lanes lower = 0., upper = 0., x = 0.;
      where(flows, upper) = largest / threefold_shear;
      where(flows, x) = (scale - load_lanes(points.flow)) / (threefold_shear + points.hardening);
      LaneMask is_open = flows;
      for (unsigned int iteration = 0; iteration < max_iterations && any_of(is_open); ++iteration)
      {
        store_lanes(old_strain + x, points.strain);
        evaluate_flow(points, x, temperature, rate);
        points.set(terms);
        const Lanes residual =
            points.effective - x * (threefold_shear + points.modulus) - load_lanes(points.flow);
        where(is_open && residual > 0., lower) = x;
        where(is_open && !(residual > 0.), upper) = x;
        Lanes next = x + residual / (threefold_shear + points.hardening + load_lanes(points.slope));
        const LaneMask is_inside = next >= lower && next <= upper;
        // Across a kink of the flow stress, Newton's method can go to and fro between both bounds.
        const LaneMask halves = !is_inside || LaneMask(iteration >= 8 && iteration % 2 == 0);
        where(halves, next) = 0.5 * (lower + upper);
        where(is_open, x) = next;
        is_open = is_open && (halves || abs(residual) > tolerance * scale);
      }
      store_lanes(old_strain + x, points.strain);
      evaluate_flow(points, x, temperature, rate);
      points.set(terms);
      return true;
    }

    /** Keeps the state of points that flow; others keep their digits. */
    void keep(const MaterialBatch &batch, const unsigned int i, const Return &points,
              const Lanes &old_shear, double *const thermal_work) const
    {
      const Lanes x = load_lanes(points.increment);
      const LaneMask flows = x > 0.;
      const Tensor direction = points.direction();
      Lanes volumetric = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        volumetric += load_lanes(batch.strain_increment[c] + i);
      Tensor old, stress, flow;
      for (unsigned int c = 0; c < 6; ++c)
      {
        const Lanes strain = load_lanes(batch.strain_increment[c] + i) -
                             (c < 3 ? volumetric * (1. / 3.) : Lanes(0.));
        old[c] = (points.trial[c] - 2. * points.shear * strain) * (old_shear / points.shear);
        flow[c] = x * direction[c];
        stress[c] = points.trial[c] - 2. * points.shear * flow[c];
        Lanes whole = load_lanes(batch.stress[c] + i);
        where(flows, whole) = whole - 2. * points.shear * flow[c];
        store_lanes(whole, batch.stress[c] + i);
      }
      Lanes work = 0.5 * (contract(old, flow) + contract(stress, flow)), stored = 0.;
      for (std::size_t k = 0; k < terms.size(); ++k)
      {
        const std::array<double *, 6> back_entry = back_stress(batch, k, i);
        const Lanes w = 1. / (1. + terms[k].recovery * x);
        Tensor back = points.old_back[k];
        for (unsigned int c = 0; c < 6; ++c)
        {
          where(flows, back[c]) = w * (back[c] + (2. / 3.) * terms[k].modulus * flow[c]);
          store_lanes(back[c], back_entry[c]);
        }
        stored += 0.75 / terms[k].modulus *
                  (contract(back, back) - contract(points.old_back[k], points.old_back[k]));
      }
      const auto add = [i](double *const values, const Lanes &value)
      { store_lanes(load_lanes(values + i) + value, values + i); };
      add(batch.internal_variables[effective_plastic_strain], x);
      add(batch.internal_variables[stored_work], stored);
      add(batch.internal_variables[plastic_work], work - stored);
      if (has_tables())
      {
        // The elastic update took the work of the change of G with the trial stress as the new one.
        Tensor difference;
        for (unsigned int c = 0; c < 6; ++c)
          difference[c] = stress[c] - points.trial[c];
        add(thermal_work, 0.25 * (1. / old_shear - 1. / points.shear) * contract(old, difference));
      }
    }

    /** Subtracts plastic flow from the tangent from @p i on: dΔp = N : ds_trial/D. */
    void soften(const unsigned int i, const Return &points, const MaterialTangent &tangent) const
    {
      constexpr double round_off = 1e-12;
      const Lanes x = load_lanes(points.increment), twice_shear = 2. * points.shear;
      Lanes share = x / points.effective; // Δp/|A|
      // Whether a point on the yield surface flows depends on its last digit. Unloading begins
      // there, and must not begin without the elastic stiffness.
      where(!(3. * points.shear * share > round_off), share) = 0.;
      const LaneMask flows = share > 0.;
      if (none_of(flows))
        return;
      const Tensor n = points.direction();
      const Lanes across = contract(n, points.change);
      Lanes compliance = 1. / (3. * points.shear + points.hardening + load_lanes(points.slope));
      where(!flows, compliance) = 0.;
      for (unsigned int row = 0; row < 6; ++row)
      {
        const Lanes turned = n[row] + share * (1.5 * points.change[row] - across * n[row]);
        const Lanes along = share * n[row] - compliance * turned;
        for (unsigned int column = 0; column < 6; ++column)
        {
          const double deviatoric =
              (row == column ? 1. : 0.) - (row < 3 && column < 3 ? 1. / 3. : 0.);
          const Lanes change =
              twice_shear * twice_shear * along * (column < 3 ? 1. : 2.) * n[column] -
              1.5 * twice_shear * twice_shear * share * deviatoric;
          double *const entry = tangent[6 * row + column] + i;
          store_lanes(load_lanes(entry) + change, entry);
        }
      }
    }

    std::unique_ptr<const FlowStress> flow_stress;
    double taylor_quinney;
    std::vector<BackStress> terms;
  };

  TOMBOLO_REGISTER(Material, Chaboche, "chaboche",
                   "elastic, with plastic flow around a back stress (kinematic hardening): yields "
                   "earlier when loaded backwards")
} // namespace tombolo
