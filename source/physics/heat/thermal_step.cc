// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/heat/thermal_step.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void ThermalStep<dim>::declare_parameters(ParameterHandler &handler)
  {
    handler.declare_entry(
        "Time integration", "explicit",
        Patterns::Selection(Registry<HeatIntegrator<dim>>::instance().selection()),
        "How heat is advanced in time.");
    Registry<HeatIntegrator<dim>>::instance().declare_all(handler);
  }

  template <int dim>
  ThermalStep<dim>::ThermalStep(const Section &heat)
  {
    const std::string name = heat.get("Time integration");
    scheme = Registry<HeatIntegrator<dim>>::instance().create(name, heat.subsection(name));
  }

  template <int dim>
  void ThermalStep<dim>::start(Model<dim> &model, const double time)
  {
    ThermalState &state = model.heat->state;
    entered.assign(model.heat->conditions.n_conditions(), 0.);
    entering = entered;
    time_of_state = next_time = present_time = time;
    // What prescribed temperatures do at once belongs to the beginning, not to the balance.
    std::vector<double> of_condition(entered.size(), 0.);
    model.heat->find_temperature(time, state.enthalpy, state.unsmoothed_temperature, of_condition);
    model.heat->find_field_of_state(model.state.position);
    state.present_temperature.copy_from(state.temperature);
  }

  template <int dim>
  double ThermalStep<dim>::begin_step(Model<dim> &model, const double target)
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
    model.heat->find_field(model.state.position, state.next_unsmoothed_temperature,
                           state.next_temperature); // (40)
    next_time = n == 1. ? target : time_of_state + step;
    is_in_progress = true;
    smallest = std::min(smallest, step);
    largest = std::max(largest, step);
    check(model);
    seconds_spent +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return step;
  }

  template <int dim>
  void ThermalStep<dim>::complete_step(Model<dim> &model)
  {
    ThermalModel<dim> &heat = *model.heat;
    ThermalState &state = heat.state;
    std::swap(state.enthalpy, state.next_enthalpy);
    std::swap(state.unsmoothed_temperature, state.next_unsmoothed_temperature);
    std::swap(state.temperature, state.next_temperature);
    for (std::size_t c = 0; c < entered.size(); ++c)
      entered[c] += entering[c];
    heat.eroded_heat += std::exchange(heat.eroding_heat, 0.);
    time_of_state = next_time;
    is_in_progress = false;
    ++count;

    if (!model.has_mechanics)
      heat.keep_field_of_state();
    if (!model.has_heat_sources())
      return;
    heat.add_plastic_heat(state.enthalpy);
    if (model.has_contact_heat())
    {
      if (contact_heat.partition() != state.enthalpy.partition())
        contact_heat.reinit(state.enthalpy.partition(), 1);
      contact_heat.set_zero();
      for (const auto &contact : model.contacts)
        contact->add_heat(contact_heat);
      heat.add_surface_heat(model.state.position, contact_heat, state.enthalpy);
    }
    heat.find_temperature(time_of_state, state.enthalpy, state.unsmoothed_temperature, entered);
    heat.find_field(model.state.position, state.unsmoothed_temperature, state.temperature);
  }

  template <int dim>
  double ThermalStep<dim>::fraction() const
  {
    return is_in_progress && next_time > time_of_state
               ? (present_time - time_of_state) / (next_time - time_of_state)
               : 0.;
  }

  template <int dim>
  bool ThermalStep<dim>::bring_to(Model<dim> &model, const double time, const double target,
                                  const std::function<bool()> &must_stop)
  {
    constexpr unsigned long patience = 1000, interval = 16;
    const unsigned long first = count;
    while (true)
    {
      if (count - first > patience && is_in_progress && count % interval == 0 && must_stop &&
          must_stop())
        return false;
      if (is_in_progress && next_time <= time)
        complete_step(model);
      else if (!is_in_progress && time_of_state < time)
        begin_step(model, std::max(target, time));
      else
        break;
    }
    present_time = time;
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

  template <int dim>
  void ThermalStep<dim>::check(const Model<dim> &model) const
  {
    const ThermalModel<dim> &heat = *model.heat;
    std::string failure = heat.conditions.failure();
    for (unsigned int i = 0; i < heat.state.enthalpy.partition()->n_owned() && failure.empty(); ++i)
      if (!std::isfinite(*heat.state.next_unsmoothed_temperature.node(i)))
      {
        const double *const x = model.state.position.node(i);
        std::ostringstream message;
        message.precision(6);
        message << "The temperature of node " << model.nodes->persistent_ids()[i]
                << " is not finite at time " << next_time << ". It is at (" << x[0] << ", " << x[1]
                << ", " << x[2] << "). A smaller thermal step may help.";
        failure = message.str();
      }
    throw_on_all_ranks<RunError>(failure, model.communicator);
  }

  template <int dim>
  HeatBalance ThermalStep<dim>::balance(const Model<dim> &model)
  {
    const ThermalState &state = model.heat->state;
    const double s = fraction();
    std::vector<double> sums(4 + entered.size(), 0.);
    for (unsigned int i = 0; i < state.enthalpy.partition()->n_owned(); ++i)
    {
      const double now = *state.enthalpy.node(i);
      const double present = s == 0. ? now : (1. - s) * now + s * *state.next_enthalpy.node(i);
      sums[0] += present;
      sums[3] += std::abs(present);
    }
    double friction = 0, conducted = 0;
    for (const Part<dim> &part : model.parts)
      if (model.has_mechanics)
      {
        sums[1] += part.formulation->pending_plastic_heat();
        sums[2] += part.material->plastic_heat_fraction() * part.formulation->energies().plastic;
      }
    for (const auto &contact : model.contacts)
    {
      sums[1] += contact->heat_to_give();
      const ContactBalance balance = contact->balance(model.communicator);
      friction += contact->heat_fraction() * balance.friction;
      conducted += balance.conducted;
    }
    for (std::size_t c = 0; c < entered.size(); ++c)
      sums[4 + c] = entered[c] + s * entering[c];
    sums.push_back(model.heat->eroded_heat + s * model.heat->eroding_heat);
    sums = ordered_sum(sums, model.communicator);

    HeatBalance result;
    result.enthalpy = sums[0];
    result.pending = sums[1];
    result.plastic = sums[2];
    result.friction = friction;
    result.conducted = conducted;
    result.eroded = sums.back();
    sums.pop_back();
    result.of_condition.assign(sums.begin() + 4, sums.end());
    result.entered = std::accumulate(sums.begin() + 4, sums.end(), 0.);
    if (!has_start)
    {
      has_start = true;
      initial_enthalpy =
          result.enthalpy + result.pending - result.entered - result.plastic - friction - conducted;
    }
    result.initial_enthalpy = initial_enthalpy;
    for (const double value :
         {sums[3], result.entered, result.plastic, friction, conducted, initial_enthalpy})
      largest_scale = std::max(largest_scale, std::abs(value));
    for (const double value : result.of_condition)
      largest_scale = std::max(largest_scale, std::abs(value));
    const double difference = result.enthalpy + result.pending + result.eroded - initial_enthalpy -
                              result.entered - result.plastic - friction - conducted;
    result.error = largest_scale > 0. ? difference / largest_scale : 0.;
    return result;
  }

  template <int dim>
  unsigned long ThermalStep<dim>::n_steps() const
  {
    return count;
  }

  template <int dim>
  double ThermalStep<dim>::smallest_step() const
  {
    return smallest;
  }

  template <int dim>
  double ThermalStep<dim>::largest_step() const
  {
    return largest;
  }

  template <int dim>
  const StepLimit &ThermalStep<dim>::limit() const
  {
    return scheme->limit();
  }

  template <int dim>
  double ThermalStep<dim>::allowed_step(Model<dim> &model)
  {
    return scheme->allowed_step(model, time_of_state);
  }

  template <int dim>
  double ThermalStep<dim>::seconds() const
  {
    return seconds_spent;
  }

  template <int dim>
  void ThermalStep<dim>::serialize(StateArchive &archive, Model<dim> &model)
  {
    const auto group = archive.group("thermal step");
    archive("time", time_of_state);
    archive("next time", next_time);
    archive("present time", present_time);
    archive("is in progress", is_in_progress);
    archive("steps", count);
    archive("smallest", smallest);
    archive("largest", largest);
    archive("largest scale", largest_scale);
    archive("has start", has_start);
    archive("initial enthalpy", initial_enthalpy);
    entered.resize(model.heat->conditions.n_conditions());
    entering.resize(entered.size());
    std::vector<double *> shares;
    for (double &value : entered)
      shares.push_back(&value);
    for (double &value : entering)
      shares.push_back(&value);
    archive.sums("heat of conditions", shares);
    if (model.erodes())
      archive.sums("eroded heat", {&model.heat->eroded_heat, &model.heat->eroding_heat});
    if (model.erodes() || model.loses_bonds() || model.converts())
      archive("limit is outdated", model.heat->limit_is_outdated);
    scheme->serialize(archive, model);
  }

  template <int dim>
  void ThermalStep<dim>::add_to_summary(Summary &summary) const
  {
    scheme->add_to_summary(summary);
  }

  template class ThermalStep<2>;
  template class ThermalStep<3>;
} // namespace tombolo
