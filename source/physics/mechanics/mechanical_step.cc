// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mechanical_step.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/coupling/spread_loads.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  MechanicalStep<dim>::MechanicalStep(Model<dim> &model, EnergyLedger &ledger)
      : model(model), ledger(ledger)
  {}

  template <int dim>
  MechanicalStep<dim>::~MechanicalStep()
  {
    if (check_request != MPI_REQUEST_NULL)
      MPI_Wait(&check_request, MPI_STATUS_IGNORE);
  }

  template <int dim>
  bool MechanicalStep<dim>::evaluate_acceleration(const Clock &clock)
  {
    end_check();
    stopwatch.start();
    if (model.erodes())
      erode(clock);
    const bool has_converted = model.converts() && convert(clock);
    const bool has_new_neighbours = model.update_neighbourhoods(); // φ, ∇φ at the current reference
    if (has_new_neighbours || has_converted)
      ledger.forget_load_history();
    const bool has_new_masses = model.scaling && raise_masses(clock);
    stopwatch.lap("neighbourhoods");
    model.bridge->smooth_velocity(model.state); // (10)-(12), (48)-(50)
    stopwatch.lap("smoothing");
    add_internal_force(clock); // (13), (5), (16), (19), (51)
    if (model.conditions->has_loads())
    {
      model.conditions->compute_loads(model.state, clock.time, model.loads,
                                      model.scaling ? &model.true_mass : nullptr);
      model.bridge->force_of_loads(model.loads, model.load_force);
    }
    if (!model.contacts.empty())
      model.compute_contact_force(clock);
    if (!model.conditions->failure().empty() && local_failure.empty())
      local_failure = "In step " + std::to_string(clock.step) + ": " + model.conditions->failure();
    stopwatch.lap("loads");
    divide_by_mass(clock); // (20)
    begin_check();
    stopwatch.lap("acceleration");
    return has_new_neighbours || has_new_masses || has_converted;
  }

  template <int dim>
  bool MechanicalStep<dim>::raise_masses(const Clock &clock)
  {
    if (!model.scaling->is_due(clock.step))
      return false;
    NodalVector before;
    before.reinit(model.state.partition(), 1);
    before.copy_from(model.state.mass);
    if (!model.raise_masses(clock.step))
      return false;
    ledger.add_mass_scaling(model.state, before);
    return true;
  }

  template <int dim>
  void MechanicalStep<dim>::erode(const Clock &clock)
  {
    if (!model.find_failed_cells())
      return;
    ledger.book_first_half(model.state, *model.bridge, model.conditions->constrained_nodes(),
                           model.conditions->constrained_components());
    ErosionLoss loss;
    model.remove_failed_cells(clock, loss);
    ledger.add_erosion(loss);
  }

  template <int dim>
  bool MechanicalStep<dim>::convert(const Clock &clock)
  {
    if (!model.find_converting_cells(clock.step))
      return false;
    model.bridge->smooth_velocity(model.state); // that of the half step, by the rows of before
    ledger.book_first_half(model.state, *model.bridge, model.conditions->constrained_nodes(),
                           model.conditions->constrained_components());
    double lost_energy = 0;
    model.convert(lost_energy);
    ledger.add_conversion(lost_energy);
    return true;
  }

  template <int dim>
  void MechanicalStep<dim>::complete_acceleration(const Clock &clock)
  {
    stopwatch.start();
    model.conditions->prescribe_acceleration(model.state, clock.time, clock.velocity_step(),
                                             clock.next_step);
    for (const unsigned int node : model.massless_nodes)
      std::fill_n(model.state.acceleration.node(node), node_stride, 0.);
    model.state.acceleration.update_ghosts();
    for (const auto &contact : model.contacts)
      contact->complete_step(clock);
    if (!model.contacts.empty())
      ledger.add_contact_force(model.state, clock, model.contact_force);
    ledger.accumulate(model.state, *model.bridge, clock,
                      model.conditions->has_loads() ? &model.load_force : nullptr,
                      model.conditions->constrained_nodes(),
                      model.conditions->constrained_components());
    stopwatch.lap("acceleration");
  }

  template <int dim>
  void MechanicalStep<dim>::advance(const Clock &clock)
  {
    stopwatch.start();
    const bool filters = model.filter.power > 0 && (clock.step + 1) % model.filter.interval == 0;
    if (filters)
    {
      if (half_kick.partition() != model.state.partition())
        half_kick.reinit(model.state.partition());
      half_kick.copy_from(model.state.unsmoothed_velocity);
    }
    model.bridge->advance(model.state, clock.velocity_step(),
                          clock.next_step); // (22)-(25), (52)-(56)
    for (const auto &contact : model.contacts)
      contact->advance(clock);
    stopwatch.lap("motion");
    time_since_filter += clock.next_step;
    if (filters)
    {
      apply_lattice_filter();
      stopwatch.lap("lattice filter");
    }
    ledger.add_constraint_reaction(model.bridge->take_constraint_reaction());
  }

  template <int dim>
  void MechanicalStep<dim>::apply_lattice_filter()
  {
    // What the scheme conserves is ½ v_n·M̂ v_n - Δt²/8 a·M a + U with v_n = (v⁻ + v⁺)/2. A filter
    // of v⁺ would change it by a term of either sign, which, taken at one phase of a short wave
    // every few steps, can make that wave grow.
    NodalVector &v_hat = model.state.unsmoothed_velocity;
    const std::size_t n = static_cast<std::size_t>(v_hat.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
    {
      half_kick.data()[i] = 0.5 * (v_hat.data()[i] - half_kick.data()[i]);
      v_hat.data()[i] -= half_kick.data()[i];
    }
    ledger.add_filtered(model.bridge->filter(model.state, model.filter, time_since_filter));
    for (std::size_t i = 0; i < n; ++i)
      v_hat.data()[i] += half_kick.data()[i];
    v_hat.update_ghosts();
    time_since_filter = 0;
  }

  template <int dim>
  void MechanicalStep<dim>::add_internal_force(const Clock &clock)
  {
    NodalState &state = model.state;
    state.force.set_zero();
    const bool is_trace = model.bridge->is_trace();
    if (is_trace && element_force.partition() != state.partition())
      element_force.reinit(state.partition());
    if (is_trace)
      element_force.set_zero();
    const NodalVector &element_velocity = model.bridge->element_velocity(state.velocity);
    for (Part<dim> &part : model.parts)
    {
      const bool sees_particles = part.particles == nullptr && is_trace;
      const MechanicalInput input{
          &state.position, sees_particles ? &element_velocity : &state.velocity,
          clock.previous_step, model.heat ? &model.heat->state.present_temperature : nullptr};
      // A failure is known to one rank alone; all must hear of it before any leaves.
      std::string failure;
      try
      {
        part.formulation->add_internal_force(input, sees_particles ? element_force : state.force);
        failure = part.formulation->failure();
      }
      catch (const RunError &error)
      {
        failure = error.what();
      }
      if (!failure.empty() && local_failure.empty())
        local_failure = "At time " + std::to_string(clock.time) + ", step " +
                        std::to_string(clock.step) + ", part \"" + part.name + "\": " + failure;
      stopwatch.lap(part.particles != nullptr ? "particle forces" : "element forces");
    }
    if (model.has_self_contact())
    {
      add_self_contact({&state.position, &state.velocity, clock.previous_step});
      stopwatch.lap("self-contact");
    }
    state.force.add_to_owners();
    if (is_trace)
      model.bridge->collect_element_force(element_force, state.force);
  }

  template <int dim>
  void MechanicalStep<dim>::add_self_contact(const MechanicalInput &input)
  {
    if (fragment_loads.partition() != model.state.partition())
      fragment_loads.reinit(model.state.partition());
    loaded_fragment_nodes.clear();
    for (const Part<dim> &part : model.parts)
      if (part.particles != nullptr)
        part.particles->add_self_contact(input, model.element_mass, fragment_loads,
                                         loaded_fragment_nodes);
    spread_loads(*model.bridge, loaded_fragment_nodes, fragment_loads, model.state.force);
  }

  template <int dim>
  void MechanicalStep<dim>::divide_by_mass(const Clock &clock)
  {
    NodalState &state = model.state;
    const unsigned int n_owned = state.partition()->n_owned();
    if (model.conditions->has_loads())
      for (const unsigned int node : model.bridge->nodes_touched_by_loads())
        if (node < n_owned)
          store_node(load_node(state.force.node(node)) + load_node(model.load_force.node(node)),
                     state.force.node(node));
    if (!model.contacts.empty())
      for (unsigned int node = 0; node < n_owned; ++node)
        store_node(load_node(state.force.node(node)) + load_node(model.contact_force.node(node)),
                   state.force.node(node));
    const NodalVector &mass = model.bridge->nodal_mass();
    NodeLanes sum = 0.;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const NodeLanes acceleration = load_node(state.force.node(i)) / load_node(mass.node(i));
      store_node(acceleration, state.acceleration.node(i));
      sum += acceleration * 0.; // not finite where a term is not
    }
    if (std::isfinite(sum[0] + sum[1] + sum[2]) || !local_failure.empty())
      return;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const a = state.acceleration.node(i);
      if (std::isfinite(a[0] + a[1] + a[2]))
        continue;
      const double *const x = state.position.node(i);
      const double *const start = state.initial_position.node(i);
      const auto owned_index = static_cast<std::size_t>(i);
      std::ostringstream message;
      message.precision(6);
      message << "The acceleration of node " << model.nodes->persistent_ids()[owned_index]
              << " is not finite at time " << clock.time << ", step " << clock.step
              << ". It is at (" << x[0] << ", " << x[1] << ", " << x[2] << "), initially at ("
              << start[0] << ", " << start[1] << ", " << start[2]
              << "). A smaller time step, or another formulation there, may help.";
      local_failure = message.str();
      return;
    }
  }

  template <int dim>
  void MechanicalStep<dim>::begin_check()
  {
    has_failed = local_failure.empty() ? 0 : 1;
    MPI_Iallreduce(&has_failed, &any_has_failed, 1, MPI_INT, MPI_MAX, model.communicator,
                   &check_request);
  }

  template <int dim>
  void MechanicalStep<dim>::end_check()
  {
    if (check_request == MPI_REQUEST_NULL)
      return;
    MPI_Wait(&check_request, MPI_STATUS_IGNORE);
    if (any_has_failed == 0)
      return;
    for (const std::string &failure : Utilities::MPI::all_gather(model.communicator, local_failure))
      if (!failure.empty())
        throw RunError(failure);
  }

  template <int dim>
  void MechanicalStep<dim>::serialize(StateArchive &archive)
  {
    const auto group = archive.group("mechanical step");
    archive("time since filter", time_since_filter);
  }

  template <int dim>
  const Stopwatch &MechanicalStep<dim>::times() const
  {
    return stopwatch;
  }

  template <int dim>
  void MechanicalStep<dim>::check_now()
  {
    end_check();
  }

  template class MechanicalStep<2>;
  template class MechanicalStep<3>;
} // namespace tombolo
