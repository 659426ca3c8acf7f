// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/model/step_limit.h>
#include <tombolo/physics/heat/growing_rates.h>
#include <tombolo/physics/heat/thermal_step.h>
#include <tombolo/physics/mechanics/lobpcg.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  namespace
  {
    // Eigenvalues are approached from below: the margin covers the error by the tolerance.
    constexpr double largest_share = 0.994;
    // Properties that depend on the temperature change the spectrum without changing lengths.
    constexpr unsigned int check_interval = 20;
    // By so much a step is far below the limit: gradients can become three times as steep before
    // particles are isolated, which reduces the limit to a ninth.
    constexpr double large_reserve = 16.;
  } // namespace

  /** The forward Euler method of eqs (36), (37), (39), with the stable step of the spectrum of
   * the real operator, 2/λ. */
  template <int dim>
  class ExplicitHeat : public HeatIntegrator<dim>
  {
  public:
    explicit ExplicitHeat(const Entries &e) : solver(1e-4, 400, Quantity::scalars)
    {
      safety_factor = e.number("Safety factor", "0.9", positive_up_to(1.), "",
                               "The step is this fraction of the limit, that of the largest "
                               "eigenvalue of the real operator, above 0 and up to 1.");
      maximum = e.number("Maximum", "0", at_least(0.), "T",
                         "The largest step allowed; 0 is no limit of its own.");
    }

    double allowed_step(const Model<dim> &model, const double time) override
    {
      find_limit(model, time);
      ++steps_since_check;
      // The largest eigenvalue of a constant operator cannot be exceeded.
      if (!model.has_mechanics && model.heat->is_linear())
        return step_of_limit();
      find_rate(model, time);
      has_rate = true;
      const double step = step_of_limit();
      shown_eigenvalue = growing_rates.find_eigenvalue(model, time, rate, step);
      correct_limit(model, time, step);
      return step_of_limit();
    }

    void advance(const Model<dim> &model, const double time, const double time_step,
                 std::vector<double> &condition_heats) override
    {
      ThermalState &state = model.heat->state;
      if (!std::exchange(has_rate, false))
        find_rate(model, time);
      for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
        *state.next_enthalpy.node(i) = *state.enthalpy.node(i) + time_step * *rate.node(i); // (36)
      for (std::size_t c = 0; c < rates_of_conditions.size(); ++c)
        condition_heats[c] += time_step * rates_of_conditions[c];
      model.heat->find_temperature(time + time_step, state.next_enthalpy,
                                   state.next_unsmoothed_temperature, condition_heats);
    }

    void mesh_has_changed() override
    {
      clear_estimate();
      has_rate = false;
    }

    const StepLimit &limit() const override
    {
      return present;
    }

    void list(Records &records, const Model<dim> &model) override
    {
      has_rate = false;
      Records &all = records.group("explicit heat");
      tombolo::list(all, present);
      all.value("paper's limit at estimate", paper_limit_at_estimate);
      all.value("steps since look", steps_since_check);
      all.value("calls", n_calls);
      growing_rates.list(all);
      all.list(
          [this, &model](Records &now)
          {
            if (n_calls == 0)
              return;
            solver.set_partition(model.state.partition());
            now.nodal("mode", 1, solver.mode);
          });
    }

  private:
    void find_limit(const Model<dim> &model, const double time)
    {
      ThermalModel<dim> &heat = *model.heat;
      // Temperatures change in time: over the same time as otherwise, `Maximum` needs more steps.
      const double reserve =
          n_calls > 0 && maximum > 0. ? safety_factor * present.time_step / maximum : 1.;
      const bool is_far = reserve > large_reserve;
      if (is_far && steps_since_check % check_interval != 0)
        return;
      const StepLimit paper = heat.diffusion_limit(model.state.position);
      const bool has_films = heat.conditions.has_films();
      if (paper.time_step > 1e299 && !has_films)
      {
        present = paper;
        return;
      }
      const bool has_changed =
          is_far ? paper.time_step * reserve < large_reserve * paper_limit_at_estimate
                 : heat.limit_is_outdated || std::abs(paper.time_step - paper_limit_at_estimate) >
                                                 0.01 * paper_limit_at_estimate;
      if (n_calls > 0 && !has_changed &&
          (heat.is_linear() || steps_since_check < check_interval * std::max(1., reserve)))
        return;
      steps_since_check = 0;
      heat.limit_is_outdated = false;
      paper_limit_at_estimate = paper.time_step;

      const auto &partition = heat.state.enthalpy.partition();
      capacity.reinit(partition, Quantity::scalar);
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        *capacity.node(i) =
            heat.nodal_enthalpy.capacity(i, *heat.state.unsmoothed_temperature.node(i));
      solver.set_partition(partition);
      solver.add_noise(capacity, model.state.initial_position, 1, n_calls == 0 ? 1. : 0.1, n_calls);
      solver.mode.fill(heat.conditions.constrained_nodes(),
                       [](const std::size_t, double *const value) { *value = 0.; });
      if (has_films)
        heat.conditions.update_areas(model.state.position); // they are not current yet
      const double largest = solver.find(
          capacity,
          [&](const NodalVector &direction, NodalVector &image)
          {
            heat.apply_conduction(model.state.position, heat.state.temperature, time, direction,
                                  image);
            image.fill([&](const unsigned int i, double *const value)
                       { *value /= *capacity.node(i) > 0. ? *capacity.node(i) : 1.; });
          },
          n_calls == 0 ? solver.from_noise(static_cast<double>(partition->n_global()))
                       : solver.from_last_mode());
      ++n_calls;
      present = paper;
      present.time_step = largest > 0. ? largest_share * 2. / largest : 1e300;
      present.entity = "spectrum";
    }

    void clear_estimate()
    {
      n_calls = 0;
      paper_limit_at_estimate = 0;
      solver.mode = NodalVector();
    }

    /** @p time_step is the present one of find_limit(). */
    void correct_limit(const Model<dim> &model, const double time, const double time_step)
    {
      if (time_step * shown_eigenvalue <= 2.)
        return;
      // Few iterations do not lead from the last mode to one in another region.
      clear_estimate();
      find_limit(model, time);
      present.time_step = std::min(present.time_step, largest_share * 2. / shown_eigenvalue);
    }

    double step_of_limit() const
    {
      const double step = round_down(safety_factor * present.time_step);
      return maximum > 0. ? std::min(step, maximum) : step;
    }

    void find_rate(const Model<dim> &model, const double time)
    {
      ThermalModel<dim> &heat = *model.heat;
      const auto &partition = heat.state.enthalpy.partition();
      rate.fit_to(partition, Quantity::scalar);
      rates_of_conditions.assign(heat.conditions.n_conditions(), 0.);
      heat.find_field_of_state(); // (28)
      heat.heat_rate(model.state.position, heat.state.temperature, time, rate,
                     rates_of_conditions); // (29), (32)-(35), (37)-(39)
    }

    double safety_factor;
    double maximum;
    Lobpcg solver;
    StepLimit present;
    double paper_limit_at_estimate = 0;
    unsigned int steps_since_check = 0;
    unsigned int n_calls = 0;
    NodalVector rate, capacity;
    std::vector<double> rates_of_conditions;
    bool has_rate = false; ///< of the state that advance() will be given
    GrowingRates<dim> growing_rates;
    double shown_eigenvalue = 0; ///< by rates that grow, at the coming step
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(HeatIntegrator, ExplicitHeat, "explicit",
                                  "forward Euler steps below the stable one")
} // namespace tombolo
