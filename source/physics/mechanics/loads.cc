// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/loads.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/output/output.h>
#include <tombolo/state/dependent_nodes.h>

#include <functional>
#include <string>

namespace tombolo
{
  template <int dim>
  Loads<dim>::Loads(const Model<dim> &model)
      : conditions(*model.conditions), loads(this->actions.add("loads", ActsAt::loads)),
        of_conditions(model, false)
  {
    loads.books("external work", EnergyKind::external).comes_from_outside().stays_on_rank();
    model.signals.change.connect(
        [this, &model]
        {
          add_works(model, [](SingleLoad &load, const NodalVector &velocity, double &work)
                    { load.work.begin_change(velocity, work); });
        });
    this->observed.views.connect(
        [this](OutputView<dim> &view)
        { view.condition_balances.push_back([this] { return balances(); }); });
    for (unsigned int c = 0; c < conditions.all().size(); ++c)
      if (!prescribes(conditions.all()[c].type))
        single.push_back({c, {}, {}});
    if (single.size() == 1)
      single.clear();
    Records &all = this->records.group("loads");
    of_conditions.list(all);
    for (SingleLoad &load : single)
      load.work.list("previous impulse of " + std::to_string(load.condition), all);
  }

  template <int dim>
  void Loads<dim>::model_changed(const Model<dim> &model)
  {
    loaded_nodes =
        with_nodes_depended_on(model.state.partition(), conditions.loaded_nodes(model.state));
    if (model.bridge->has_particles())
      places.reinit(model.state.partition(), model.state.position.quantity());
  }

  template <int dim>
  const NodalVector &Loads<dim>::velocity_at_places(const Model<dim> &model)
  {
    if (!model.bridge->has_particles())
      return model.state.velocity;
    place_velocities.fit_to(model.state.partition());
    model.bridge->load_transfer().places_of_loads(loaded_nodes, model.state.velocity,
                                                  place_velocities);
    return place_velocities;
  }

  template <int dim>
  template <typename Add>
  void Loads<dim>::add_works(const Model<dim> &model, const Add &add)
  {
    if (single.empty())
      return;
    const NodalVector &velocity = velocity_at_places(model);
    for (SingleLoad &load : single)
    {
      double work = 0;
      add(load, velocity, work);
      of_conditions[load.condition].work += work;
    }
  }

  template <int dim>
  void Loads<dim>::add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &)
  {
    const bool has_particles = model.bridge->has_particles();
    if (has_particles)
      model.bridge->load_transfer().places_of_loads(loaded_nodes, model.state.position, places);
    std::function<void(unsigned int, const NodalVector &)> take_alone;
    if (!single.empty())
      take_alone = [this](const unsigned int condition, const NodalVector &alone)
      {
        for (SingleLoad &load : single)
          if (load.condition == condition)
            take_forces(alone, loaded_nodes, load.at_positions);
      };
    loads.touched_nodes() = loaded_nodes;
    conditions.compute_loads(model.state, clock.time, has_particles ? places : model.state.position,
                             loads.at_touched_nodes(), resultants, model.body_mass(), take_alone);
  }

  template <int dim>
  void Loads<dim>::after_acceleration(const Model<dim> &model, const Clock &clock)
  {
    of_conditions.begin_step(clock.time - 0.5 * clock.previous_step);
    of_conditions.add_loads(resultants, clock.velocity_step());
    add_works(model, [&](SingleLoad &load, const NodalVector &velocity, double &work)
              { load.work.complete_step(load.at_positions, velocity, clock, work); });
  }

  template <int dim>
  std::vector<ConditionBalance> Loads<dim>::balances() const
  {
    std::vector<ConditionBalance> result = of_conditions.balances();
    if (single.empty()) // one load, which has done all the work
      result.front().work = ordered_sum(loads.work(), loads.given().partition()->communicator());
    return result;
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
