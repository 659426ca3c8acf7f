// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <algorithm>
#include <iomanip>
#include <string>
#include <vector>

namespace tombolo
{
  namespace
  {
    template <int dim>
    std::vector<ParticleFormulation<dim> *> parts_with_pairs(const Model<dim> &model)
    {
      std::vector<ParticleFormulation<dim> *> result = model.particle_parts();
      result.erase(std::remove_if(result.begin(), result.end(),
                                  [](const auto *particles)
                                  { return particles->pairs() == nullptr; }),
                   result.end());
      return result;
    }
  } // namespace

  /**
   * The artificial viscosity and the artificial stress of particle parts that have them
   * (PairTerms), at the positions of t_n and the velocities of t_{n-1/2}. The energy that each
   * dissipates is artificial, `pair viscosity` and `artificial stress`. In scenes with heat that of
   * the viscosity heats the particles: half of a pair each, by the velocities of t_{n-1/2} over
   * Δt_n.
   *
   * The estimate of the step includes the viscosity of all pairs.
   */
  template <int dim>
  class PairForces : public Process<dim>
  {
  public:
    explicit PairForces(const Model<dim> &model)
        : model(model), dampers(parts_with_pairs(model).size())
    {
      this->roles.rest = ProcessRole::is_idle;
      const auto add = [&](const std::string &name)
      { return &this->actions.add(name, ActsAt::nodes).books(name, EnergyKind::artificial); };
      bool has_viscosity = false, has_stress = false;
      for (const auto *const particles : parts_with_pairs(model))
      {
        has_viscosity = has_viscosity || particles->pairs()->pair_terms().has_viscosity();
        has_stress = has_stress || particles->pairs()->pair_terms().has_artificial_stress();
      }
      if (has_viscosity)
      {
        viscosity = add("pair viscosity");
        this->observed.warnings.connect([this](auto &, const auto occasion, auto &warnings)
                                        { add_warnings(occasion, warnings); });
      }
      if (has_stress)
        stress = add("artificial stress");
      if (!has_viscosity || !model.heat)
        return;
      heat = &this->actions.add_heat("heat of pairs", "pair viscosity heat");
      heat->stays_on_rank();
    }

    void add_forces(const Model<dim> &, const Clock &, const NodalVector &) override
    {
      const NodalState &state = model.state;
      are_linearized = false;
      if (heat != nullptr)
        power.assign(state.partition()->n_local(), 0.);
      const auto force_of = [](Action *const action)
      { return action != nullptr ? action->at_all_nodes().data() : nullptr; };
      double *const viscous_force = force_of(viscosity), *const stress_force = force_of(stress);
      for (const auto *const particles : parts_with_pairs(model))
        particles->pairs()->pair_terms().add_forces(
            particles->pairs()->pair_rows(), particles->points(), state.position.data(),
            state.velocity.data(), viscous_force, heat != nullptr ? power.data() : nullptr,
            stress_force);
    }

    void model_changed(const Model<dim> &) override
    {
      are_linearized = false;
    }

    void linearize(const Model<dim> &, const Clock &, Tangent<dim> &tangent) override
    {
      if (viscosity == nullptr || tangent.velocity == nullptr)
        return;
      const NodalState &state = model.state;
      applied.fit_to(state.partition());
      const auto parts = parts_with_pairs(model);
      for (std::size_t k = 0; k < parts.size() && !are_linearized; ++k)
        if (const auto &pairs = *parts[k]->pairs(); pairs.pair_terms().has_viscosity())
          pairs.pair_terms().linearize_viscosity(pairs.pair_rows(), state.position.data(),
                                                 state.velocity.data(), dampers[k]);
      are_linearized = true;
      add_up({&applied},
             [&]
             {
               for (const PairDampers<dim> &part_dampers : dampers)
                 part_dampers.apply(tangent.velocity->data(), tangent.factor, applied.data());
             });
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
        store_node(load_node(tangent.force->node(i)) + load_node(applied.node(i)),
                   tangent.force->node(i));
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      if (heat == nullptr)
        return;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (power[i] > 0.)
          heat->add_heat(i, clock.velocity_step() * power[i]);
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      refuse_switch_at_rest<dim>(parameters, parts, "Artificial stress",
                                 "it acts in kernels that follow a motion");
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &, Model<dim> &model)
    {
      bool has_forces = false;
      for (const auto *const particles : parts_with_pairs(model))
        has_forces = has_forces || particles->pairs()->pair_terms().has_viscosity() ||
                     particles->pairs()->pair_terms().has_artificial_stress();
      if (!model.has_mechanics || !has_forces)
        return nullptr;
      return std::make_unique<PairForces>(model);
    }

  private:
    /** At the end of the run, where inertia is scaled, material has flowed and the viscosity has
     * dissipated more than 5 % of the plastic work. */
    void add_warnings(const typename Process<dim>::Occasion occasion,
                      std::vector<std::string> &warnings) const
    {
      if (occasion != Process<dim>::Occasion::end ||
          std::none_of(model.parts.begin(), model.parts.end(),
                       [](const Part<dim> &part)
                       { return part.material->relative_inertia() > 1.; }))
        return;
      double plastic = 0;
      for (const Part<dim> &part : model.parts)
        plastic += part.formulation->energies()["plastic dissipation"];
      plastic = ordered_sum(plastic, model.communicator);
      const double viscous = ordered_sum(-viscosity->work(), model.communicator);
      constexpr double tolerable = 0.05;
      if (plastic == 0. || !(viscous > tolerable * plastic))
        return;
      warnings.push_back(as_text(
          std::setprecision(3), "The artificial viscosity of pairs has taken ", viscous,
          ", more than 5 % of the plastic work ", plastic,
          ". It grows with the speed at which the process is run, and makes forces too large. "
          "Smaller `Artificial viscosity alpha` and `beta`, or less scaling, may help."));
    }

    const Model<dim> &model;
    Action *viscosity = nullptr, *stress = nullptr; // null: no part has it
    HeatAction *heat = nullptr;                     // null where nothing heats
    std::vector<double> power;                      // of the viscosity, by local node
    std::vector<PairDampers<dim>> dampers;          // by particle part with pairs
    bool are_linearized = false;                    // dampers, at the present state
    NodalVector applied;                            // buffer of linearize()
  };

  TOMBOLO_REGISTER_PROCESS(PairForces, process_order::loads + 2)
} // namespace tombolo
