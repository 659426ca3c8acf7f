// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/model.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  class Summary;

  /** Advances heat from one thermal time to the next: a plug-in, `Heat/Time integration`. */
  template <int dim>
  class HeatIntegrator
  {
  public:
    virtual ~HeatIntegrator() = default;

    /** The step allowed at the present state: a fraction of the stable one, or the one that the
     * user gives. Collective. */
    virtual double allowed_step(const Model<dim> &model, double time) = 0;

    /** From enthalpy, unsmoothed temperature and temperature at @p time to next_enthalpy and
     * next_unsmoothed_temperature (owned) at the end of the step, such that the change of Σ
     * next_enthalpy is that of @p condition_heats, summed over conditions and ranks, to round-off.
     * Collective. */
    virtual void advance(const Model<dim> &model, double time, double time_step,
                         std::vector<double> &condition_heats) = 0;

    /** Clears data of the nodes of the former mesh. */
    virtual void mesh_has_changed() {}

    /** The limit of the step, where there is one. */
    virtual const StepLimit &limit() const = 0;

    /** Lists the state between steps. */
    virtual void list(Records & /*records*/, const Model<dim> & /*scene*/) {}

    /** Adds its costs so far to the summary of the run. */
    virtual void add_to_summary(Summary & /*summary*/) const {}
  };

  template <int dim>
  struct PluginKind<HeatIntegrator<dim>>
  {
    static constexpr const char *name = "heat integrator";
  };

  /** The heat of a scene and its sources, at one time; sums over all ranks
   * [M L^2/T^2]. */
  struct HeatBalance
  {
    /** "enthalpy" of the nodes (zero at the initial temperatures), "heat through NAME" of each
     * condition, "plastic heat", "pending heat" (not yet given to nodes), and the heat of
     * processes. */
    EnergyAccounts heat;
    double initial_enthalpy = 0; ///< at the start
    double external = 0;         ///< entered since
    double magnitude = 0;        ///< Σ |H|
    /** (held - initial - external) / the largest of these so far, where Σ |H| replaces the
     * enthalpy. */
    double error = 0;
  };

  /**
   * Algorithm 2 of Pan et al. 2019 with its own clock (doc/method.md, section 10). The thermal step
   * in progress leads from t_n^θ to t_{n+1}^θ >= t, with all heat but that of plastic work and
   * contact in the same interval: it is collected and added when the step is complete, which for
   * the forward Euler method is the same as if it had been added before. In between, the mechanics
   * uses the temperature interpolated in time; the material points add the heat of plastic work
   * since t_n^θ. So no heat is late, lost or counted twice, at any ratio of the steps.
   */
  template <int dim>
  class ThermalStep
  {
  public:
    /** Of section "Heat". */
    explicit ThermalStep(const Entries &e)
    {
      scheme = e.plugin<HeatIntegrator<dim>>("Time integration", "explicit",
                                             "How heat is advanced in time.");
      e.plugins<HeatIntegrator<dim>>();
    }

    /** Makes the fields at the time of the beginning. Collective. */
    void start(const Model<dim> &model, const double time)
    {
      ThermalState &state = model.heat->state;
      entered.assign(model.heat->conditions.n_conditions(), 0.);
      entering = entered;
      time_of_state = next_time = present_time = time;
      // Bodies are free of stress at the temperatures before conditions prescribe others, and
      // expand from there in the first step.
      if (model.has_mechanics)
      {
        model.heat->find_free_temperature(state.enthalpy, state.unsmoothed_temperature);
        model.heat->find_field(state.unsmoothed_temperature, state.temperature);
        state.present_temperature.copy_from(state.temperature);
      }
      if (has_pending_heat(state)) // of a contact, at the end of the run that this one goes on from
        model.heat->add_pending_heat();
      // The first effect of prescribed temperatures belongs to the beginning, not to the balance.
      std::vector<double> condition_heats(entered.size(), 0.);
      model.heat->find_temperature(time, state.enthalpy, state.unsmoothed_temperature,
                                   condition_heats);
      model.heat->find_field_of_state();
      if (!model.has_mechanics)
        state.present_temperature.copy_from(state.temperature);
    }

    /** Completes the step in progress when its end is not later than @p time, and begins another
     * towards @p target, not beyond it, when needed; then interpolates the present temperature to
     * @p time. Throws RunError on all ranks when a temperature is not finite. Where there are more
     * than a thousand steps, @p must_stop is called now and then and must return the same on all
     * ranks: where it is true, returns false, with the temperature still before @p time.
     * Collective. */
    bool advance_to(const Model<dim> &model, double time, double target,
                    const std::function<bool()> &must_stop = {})
    {
      constexpr unsigned long patience = 1000, interval = 16;
      const unsigned long first = count;
      // Ends of steps that are multiples of each other meet but for the round-off of their sums.
      const double round_off = 1e-3 * std::min(time - present_time, smallest);
      while (true)
      {
        if (count - first > patience && is_in_progress && count % interval == 0 && must_stop &&
            must_stop())
          return false;
        if (is_in_progress && next_time <= time + round_off)
          complete_step(model);
        else if (!is_in_progress && time_of_state < time - round_off)
          begin_step(model, std::max(target, time));
        else
          break;
      }
      present_time = time;
      if (model.has_mechanics)
        model.heat->discard_field_of_state(); // bodies move, and processes change temperatures
      if (!is_in_progress && count == 0)
        return true; // at the beginning
      ThermalState &state = model.heat->state;
      const double s = fraction();
      const std::size_t n =
          static_cast<std::size_t>(state.temperature.partition()->n_local()) * node_stride;
      const double *const now = state.temperature.data();
      const double *const next = state.next_temperature.data();
      double *const present = state.present_temperature.data();
      if (s == 0.)
        std::copy(now, now + n, present);
      else
        for (std::size_t i = 0; i < n; i += node_stride)
          present[i] = (1. - s) * now[i] + s * next[i];
      return true;
    }

    /** Begins a step towards @p target and returns its size: in a scene without mechanics these are
     * the steps of the run. Collective. */
    double begin_step(const Model<dim> &model, const double target)
    {
      const auto begin = std::chrono::steady_clock::now();
      ThermalState &state = model.heat->state;
      const double allowed = scheme->allowed_step(model, time_of_state);
      const double remaining = target - time_of_state;
      const double n = std::max(1., std::ceil(remaining / allowed * (1. - 1e-9)));
      const double step = remaining / n;
      std::fill(entering.begin(), entering.end(), 0.);
      model.heat->eroding_heat = 0.;
      scheme->advance(model, time_of_state, step, entering);
      model.heat->find_field(state.next_unsmoothed_temperature,
                             state.next_temperature); // (40)
      next_time = n == 1. ? target : time_of_state + step;
      is_in_progress = true;
      smallest = std::min(smallest, step);
      largest = std::max(largest, step);
      check(model);
      seconds_spent += seconds_since(begin);
      return step;
    }

    /** The step of begin_step() without a target. Collective. */
    double allowed_step(const Model<dim> &model)
    {
      return scheme->allowed_step(model, time_of_state);
    }

    /** The model was replaced by one of the same time on another mesh. */
    void mesh_has_changed()
    {
      scheme->mesh_has_changed();
    }

    /** At the time of the last advance_to(). Collective. */
    HeatBalance balance(const Model<dim> &model)
    {
      HeatBalance result;
      account(model, result);
      result.external = result.heat.sum_of(EnergyKind::external);
      const double held = result.heat.total();
      if (!has_start)
      {
        has_start = true;
        initial_enthalpy = held - result.external;
      }
      result.initial_enthalpy = initial_enthalpy;
      for (const double value : {result.magnitude, result.external, initial_enthalpy})
        largest_scale = std::max(largest_scale, std::abs(value));
      for (const EnergyAccounts::Account &account : result.heat.accounts())
        if (account.kind == EnergyKind::external)
          largest_scale = std::max(largest_scale, std::abs(account.value));
      const double difference = held - initial_enthalpy - result.external;
      result.error = largest_scale > 0. ? difference / largest_scale : 0.;
      return result;
    }

    unsigned long n_steps() const
    {
      return count;
    }
    double smallest_step() const
    {
      return smallest;
    }
    double largest_step() const
    {
      return largest;
    }
    /** Of the explicit step, before the safety factor. */
    const StepLimit &limit() const
    {
      return scheme->limit();
    }

    /** Wall time of all thermal steps on this rank. */
    double seconds() const
    {
      return seconds_spent;
    }

    /** Lists the state between steps, with the error of the @p last balance. */
    void list(Records &records, const Model<dim> &model, HeatBalance &last)
    {
      records.value("time", time_of_state);
      records.value("next time", next_time);
      records.value("present time", present_time);
      records.value("is in progress", is_in_progress);
      records.value("steps", count);
      records.value("smallest", smallest);
      records.value("largest", largest);
      records.value("largest scale", largest_scale);
      records.value("has start", has_start);
      records.value("initial enthalpy", initial_enthalpy);
      records.value("last error", last.error);
      entered.resize(model.heat->conditions.n_conditions());
      entering.resize(entered.size());
      std::vector<double *> shares;
      for (std::vector<double> *const condition_heats : {&entered, &entering})
        for (double &value : *condition_heats)
          shares.push_back(&value);
      records.sums("heat of conditions", shares);
      records.sums("eroded heat", model.heat->eroded_heat, model.heat->eroding_heat);
      records.value("limit is outdated", model.heat->limit_is_outdated);
      scheme->list(records, model);
    }

    /** Adds the costs of the integrator. */
    void add_to_summary(Summary &summary) const
    {
      scheme->add_to_summary(summary);
    }

  private:
    /** Collective. */
    static bool has_pending_heat(const ThermalState &state)
    {
      bool is_pending = false;
      for (unsigned int i = 0; i < state.pending.partition()->n_owned(); ++i)
        is_pending = is_pending || *state.pending.node(i) != 0.;
      return dealii::Utilities::MPI::max(is_pending ? 1 : 0,
                                         state.pending.partition()->communicator()) == 1;
    }

    void complete_step(const Model<dim> &model)
    {
      ThermalModel<dim> &heat = *model.heat;
      ThermalState &state = heat.state;
      std::swap(state.enthalpy, state.next_enthalpy);
      std::swap(state.unsmoothed_temperature, state.next_unsmoothed_temperature);
      std::swap(state.temperature, state.next_temperature);
      for (std::size_t c = 0; c < entered.size(); ++c)
        entered[c] += entering[c];
      heat.eroded_heat += std::exchange(heat.eroding_heat, 0.);
      const double begin_of_step = std::exchange(time_of_state, next_time);
      is_in_progress = false;
      ++count;

      if (!model.has_mechanics)
        heat.keep_field_of_state();
      if (!model.has_heat_sources())
        return;
      heat.add_plastic_heat(state.enthalpy);
      bool is_given = false;
      for (const auto &process : model.processes)
        is_given = process->supply_heat(model, begin_of_step, time_of_state) || is_given;
      if (is_given)
        heat.add_pending_heat();
      heat.find_temperature(time_of_state, state.enthalpy, state.unsmoothed_temperature, entered);
      heat.find_field(state.unsmoothed_temperature, state.temperature);
      heat.keep_field_of_state();
    }

    /** Fills the accounts of @p result with sums over all ranks. Collective. */
    void account(const Model<dim> &model, HeatBalance &result) const
    {
      const ThermalState &state = model.heat->state;
      const double s = fraction();
      double enthalpy = 0, magnitude = 0;
      for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
      {
        const double now = *state.enthalpy.node(i);
        const double present = s == 0. ? now : (1. - s) * now + s * *state.next_enthalpy.node(i);
        enthalpy += present;
        magnitude += std::abs(present);
      }
      EnergyAccounts &heat = result.heat;
      heat.add("enthalpy", EnergyKind::stored, enthalpy);
      for (std::size_t c = 0; c < entered.size(); ++c)
        heat.add("heat through " + model.heat->conditions.all()[c].name, EnergyKind::external,
                 entered[c] + s * entering[c]);
      if (model.has_heat_sources())
      {
        double pending = 0, plastic = 0;
        for (unsigned int i = 0; i < state.pending.partition()->n_owned(); ++i)
          pending += *state.pending.node(i);
        if (model.has_mechanics)
          for (const Part<dim> &part : model.parts)
          {
            pending += part.formulation->pending_plastic_heat();
            plastic += part.material->plastic_heat_fraction() *
                       part.formulation->energies()["plastic dissipation"];
          }
        heat.add("plastic heat", EnergyKind::external, plastic);
        heat.add("pending heat", EnergyKind::stored, pending);
      }
      for (const auto &process : model.processes)
        process->actions.account_heat(heat);
      if (model.heat->can_lose_heat)
        heat.add("eroded heat", EnergyKind::removed,
                 model.heat->eroded_heat + s * model.heat->eroding_heat);
      heat.sum_over_ranks(model.communicator);
      result.magnitude = ordered_sum(magnitude, model.communicator);
    }

    void check(const Model<dim> &model) const
    {
      const ThermalModel<dim> &heat = *model.heat;
      std::string failure = heat.conditions.failure();
      for (unsigned int i = 0; i < heat.state.enthalpy.partition()->n_owned() && failure.empty();
           ++i)
        if (!std::isfinite(*heat.state.next_unsmoothed_temperature.node(i)))
          failure = as_text("The temperature of node ", model.nodes->persistent_ids()[i],
                            " is not finite at time ", next_time, ". It is at ",
                            position_text(vector_of<dim>(model.state.position.node(i))),
                            ". A smaller thermal step may help.");
      throw_on_all_ranks<RunError>(failure, model.communicator);
    }

    double fraction() const
    {
      return is_in_progress && next_time > time_of_state
                 ? (present_time - time_of_state) / (next_time - time_of_state)
                 : 0.;
    }

    std::unique_ptr<HeatIntegrator<dim>> scheme;
    double time_of_state = 0; ///< t_n^θ
    double next_time = 0;     ///< t_{n+1}^θ
    double present_time = 0;
    bool is_in_progress = false;
    unsigned long count = 0;
    double smallest = 1e300, largest = 0;
    double seconds_spent = 0;

    // This rank's shares of the heat through each condition: until t_n^θ, and in the step.
    std::vector<double> entered, entering;
    double largest_scale = 0;
    bool has_start = false;
    double initial_enthalpy = 0;
  };
} // namespace tombolo
