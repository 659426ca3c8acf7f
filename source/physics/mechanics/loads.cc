// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/loads.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/model.h>
#include <tombolo/output/output.h>
#include <tombolo/state/dependent_nodes.h>

#include <algorithm>
#include <functional>

namespace tombolo
{
  namespace
  {
    /** How many of these nodes (ascending) come before node @p end. */
    std::size_t n_below(const std::vector<unsigned int> &nodes, const unsigned int end)
    {
      return static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), end) -
                                      nodes.begin());
    }
  } // namespace

  template <int dim>
  Loads<dim>::Loads(const Model<dim> &model)
      : conditions(*model.conditions), of_conditions(model, false),
        works(conditions.all(), of_conditions), revision_of_stencils(model.revisions.stencils)
  {}

  template <int dim>
  std::string Loads<dim>::failure() const
  {
    return conditions.failure();
  }

  template <int dim>
  void Loads<dim>::model_changed(Model<dim> &model)
  {
    const std::vector<unsigned int> loaded_nodes =
        with_nodes_depended_on(model.state.partition(), conditions.loaded_nodes(model.state));
    model.bridge->load_transfer().set_loaded_nodes(loaded_nodes);
    works.set_nodes(loaded_nodes);
    loads.reinit(model.state.partition());
    load_force.reinit(model.state.partition());
    if (model.bridge->has_particles())
      places.reinit(model.state.partition(), model.state.position.quantity());
  }

  template <int dim>
  const NodalVector &Loads<dim>::velocity_at_places(const Model<dim> &model)
  {
    if (!model.bridge->has_particles())
      return model.state.velocity;
    if (place_velocities.partition() != model.state.partition())
      place_velocities.reinit(model.state.partition());
    model.bridge->load_transfer().places_of_loads(model.state.velocity, place_velocities);
    return place_velocities;
  }

  template <int dim>
  void Loads<dim>::prepare_change(Model<dim> &model)
  {
    const NodalState &state = model.state;
    const auto &touched = model.bridge->load_transfer().touched_nodes();
    const std::size_t n_touched = n_below(touched, state.partition()->n_owned());
    if (previous_impulse.size() >= n_touched)
      for (std::size_t k = 0; k < n_touched; ++k)
        for (unsigned int d = 0; d < 3; ++d)
          work += 0.5 * state.velocity.node(touched[k])[d] * previous_impulse[k][d];
    previous_impulse.clear();
    if (works.is_active())
      works.add_first_half(velocity_at_places(model));
    first_half_is_booked = true;
  }

  template <int dim>
  void Loads<dim>::add_forces(Model<dim> &model, const Clock &clock, NodalVector &force)
  {
    if (revision_of_stencils != model.revisions.stencils)
    {
      previous_impulse.clear(); // the list of touched nodes is another one
      works.forget();
    }
    revision_of_stencils = model.revisions.stencils;
    const bool has_particles = model.bridge->has_particles();
    if (has_particles)
      model.bridge->load_transfer().places_of_loads(model.state.position, places);
    std::function<void(unsigned int, const NodalVector &)> take_alone;
    if (works.is_active())
      take_alone = [this](const unsigned int condition, const NodalVector &alone)
      { works.take(condition, alone); };
    conditions.compute_loads(model.state, clock.time, has_particles ? places : model.state.position,
                             loads, resultants, model.is_scaled() ? &model.true_mass : nullptr,
                             take_alone);
    loads.condense();
    model.bridge->load_transfer().force_of_loads(loads, load_force);
    const unsigned int n_owned = model.state.partition()->n_owned();
    for (const unsigned int node : model.bridge->load_transfer().touched_nodes())
      if (node < n_owned)
        store_node(load_node(force.node(node)) + load_node(load_force.node(node)),
                   force.node(node));
  }

  template <int dim>
  void Loads<dim>::after_acceleration(Model<dim> &model, const Clock &clock)
  {
    const NodalState &state = model.state;
    const bool is_start = clock.step == 0;
    // Velocities are given at t_0, so that Δt_0 is half a step; as the beginning of the first
    // interval a force counts whole, like at any other.
    const double as_previous = is_start ? 2. : 1.;
    of_conditions.begin_step(clock.time - 0.5 * clock.previous_step);
    of_conditions.add_loads(resultants, clock.velocity_step());
    if (works.is_active())
      works.add_second_half(velocity_at_places(model), clock.velocity_step(), is_start);
    // K_n - K_{n-1} = ½ S v̂_{n-1/2} · (Δt_n f_n + Δt_{n-1} f_{n-1})
    const auto &touched = model.bridge->load_transfer().touched_nodes();
    const std::size_t n_touched = n_below(touched, state.partition()->n_owned());
    // Ghosts among the nodes can become other ones while the owned ones, which are first, stay.
    const bool has_history = previous_impulse.size() >= n_touched || first_half_is_booked;
    previous_impulse.resize(touched.size());
    for (std::size_t k = 0; k < n_touched; ++k)
    {
      const double *const velocity = state.velocity.node(touched[k]);
      Vector step_impulse;
      for (unsigned int d = 0; d < 3; ++d)
      {
        step_impulse[d] = clock.velocity_step() * load_force.node(touched[k])[d];
        if (!is_start)
          work += 0.5 * velocity[d] *
                  (step_impulse[d] + (has_history ? previous_impulse[k][d] : step_impulse[d]));
        previous_impulse[k][d] = as_previous * step_impulse[d];
      }
      model.impulses.add(state.position.node(touched[k]), step_impulse);
    }
    first_half_is_booked = false;
  }

  template <int dim>
  void Loads<dim>::account(EnergyAccounts &accounts) const
  {
    accounts.add("external work", EnergyKind::external, work);
  }

  template <int dim>
  void Loads<dim>::show(OutputView<dim> &view) const
  {
    view.condition_balances.emplace_back(
        [this]()
        {
          std::vector<ConditionBalance> balances = of_conditions.balances();
          if (!works.is_active()) // one load, which has done all the work
            balances.front().work = ordered_sum(work, loads.partition()->communicator());
          return balances;
        });
  }

  template <int dim>
  void Loads<dim>::serialize(Model<dim> &model, StateArchive &archive)
  {
    const auto group = archive.group("loads");
    archive.sums("work", {&work});
    archive.nodal("previous impulse", model.bridge->load_transfer().touched_nodes(),
                  previous_impulse);
    of_conditions.serialize(archive);
    if (works.is_active())
      works.serialize(archive);
    revision_of_stencils = model.revisions.stencils;
  }

  template <int dim>
  const NodalVector &Loads<dim>::at_positions() const
  {
    return loads;
  }

  template <int dim>
  const NodalVector &Loads<dim>::nodal_force() const
  {
    return load_force;
  }

  namespace
  {
    template <int dim>
    class LoadsKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (!model.has_mechanics || !model.conditions->has_loads())
          return nullptr;
        return std::make_unique<Loads<dim>>(model);
      }
    };
  } // namespace

  template class Loads<2>;
  template class Loads<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(LoadsKind, process_order::loads)
} // namespace tombolo
