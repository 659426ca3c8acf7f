// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/stopwatch.h>
#include <tombolo/model/model.h>

#include <functional>
#include <memory>
#include <vector>

namespace tombolo
{
  class Summary;

  /** How heat goes from one thermal time to the next: a plug-in, `Heat/Time integration`. */
  template <int dim>
  class HeatIntegrator
  {
  public:
    virtual ~HeatIntegrator() = default;

    /** The step allowed at the present state: a fraction of the stable one, or the one that the
     * user gives. Collective. */
    virtual double allowed_step(const Model<dim> &model, double time) = 0;

    /** From enthalpy, unsmoothed temperature and temperature at @p time to next_enthalpy and
     * next_unsmoothed_temperature (owned) at the end of the step, such that Σ next_enthalpy has
     * changed by what is added to @p of_condition, summed over conditions and ranks, to round-off.
     * Collective. */
    virtual void advance(const Model<dim> &model, double time, double time_step,
                         std::vector<double> &of_condition) = 0;

    /** Forgets what belongs to the nodes of a mesh, which is another one now. */
    virtual void mesh_has_changed() {}

    /** What limits the step, where something does. */
    virtual const StepLimit &limit() const = 0;

    /** Lists what is kept between steps. */
    virtual void list(Records & /*records*/, const Model<dim> & /*scene*/) {}

    /** Adds what it cost so far to the summary of the run. */
    virtual void add_to_summary(Summary & /*summary*/) const {}
  };

  template <int dim>
  struct PluginKind<HeatIntegrator<dim>>
  {
    static constexpr const char *name = "heat integrator";
  };

  /** Where the heat of a scene is and where it came from, at one time; sums over all ranks
   * [M L^2/T^2]. */
  struct HeatBalance
  {
    /** "enthalpy" of the nodes (zero at the initial temperatures), "heat through NAME" of each
     * condition, "plastic heat", "pending heat" (not yet given to nodes), and what processes have
     * given. */
    EnergyAccounts heat;
    double initial_enthalpy = 0; ///< at the start
    double external = 0;         ///< entered since
    double magnitude = 0;        ///< Σ |H|
    /** (held - initial - external) / the largest of these so far, where Σ |H| stands for the
     * enthalpy. */
    double error = 0;
  };

  /**
   * Algorithm 2 of Pan et al. 2019 with its own clock (doc/method.md, section 10). The thermal step
   * in progress leads from t_n^θ to t_{n+1}^θ >= t, with all heat but that of plastic work and
   * contact, which arises meanwhile: it is collected and added when the step is complete, which for
   * the forward Euler method is the same as if it had been known before. In between, the mechanics
   * sees the temperature interpolated in time; what plastic work has heated since t_n^θ, the
   * material points add themselves. So no heat is late, lost or counted twice, whatever the ratio
   * of the steps.
   */
  template <int dim>
  class ThermalStep
  {
  public:
    /** Of section "Heat". */
    explicit ThermalStep(const Entries &e);

    /** Makes the fields at the time of the beginning. Collective. */
    void start(const Model<dim> &model, double time);

    /** Completes the step in progress when its end is not later than @p time, and begins another
     * towards @p target, not beyond it, when needed; then brings the present temperature to @p
     * time. Throws RunError on all ranks when a temperature is not finite. Where it takes more than
     * a thousand steps, @p must_stop is asked now and then, which must answer alike on all ranks:
     * returns false where it says so, with the temperature still before @p time. Collective. */
    bool bring_to(const Model<dim> &model, double time, double target,
                  const std::function<bool()> &must_stop = {});

    /** Begins a step towards @p target and returns its size: in a scene without mechanics the run
     * takes these. Collective. */
    double begin_step(const Model<dim> &model, double target);

    /** The step that begin_step() would take if there were no target. Collective. */
    double allowed_step(const Model<dim> &model)
    {
      return scheme->allowed_step(model, time_of_state);
    }

    /** The model is another one of the same time, on another mesh. */
    void mesh_has_changed()
    {
      scheme->mesh_has_changed();
    }

    /** At the time of the last bring_to(). Collective. */
    HeatBalance balance(const Model<dim> &model);

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

    /** Lists what is kept between steps, with the error of the @p last balance. */
    void list(Records &records, const Model<dim> &model, HeatBalance &last);

    /** What the integrator has to say about its cost. */
    void add_to_summary(Summary &summary) const
    {
      scheme->add_to_summary(summary);
    }

  private:
    void complete_step(const Model<dim> &model);
    /** Fills the accounts of @p result with sums over all ranks. Collective. */
    void account(const Model<dim> &model, HeatBalance &result) const;
    void check(const Model<dim> &model) const;

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

    // This rank's shares of what came through each condition: until t_n^θ, and in the step.
    std::vector<double> entered, entering;
    double largest_scale = 0;
    bool has_start = false;
    double initial_enthalpy = 0;
  };
} // namespace tombolo
