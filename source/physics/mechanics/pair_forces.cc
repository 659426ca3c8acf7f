// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/pair_forces.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Calls @p use(pairs, particles, number of the particle part) for parts with pairs. */
    template <int dim, typename Use>
    void for_parts_with_pairs(const Model<dim> &model, const Use &use)
    {
      const std::vector<ParticleFormulation<dim> *> parts = model.particle_parts();
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (const PairInteractions<dim> *const pairs = parts[k]->pairs())
          use(*pairs, *parts[k], k);
    }
  } // namespace

  template <int dim>
  PairForces<dim>::PairForces(const Model<dim> &model)
      : model(model), power(model.particle_parts().size())
  {
    this->roles.rest = ProcessRole::is_idle;
    const auto add = [&](const std::string &name)
    { return &this->actions.add(name, ActsAt::nodes).books(name, EnergyKind::artificial); };
    bool has_viscosity = false, has_stress = false;
    for_parts_with_pairs(model,
                         [&](const PairInteractions<dim> &pairs, const auto &, const std::size_t)
                         {
                           has_viscosity = has_viscosity || pairs.pair_terms().has_viscosity();
                           has_stress = has_stress || pairs.pair_terms().has_artificial_stress();
                         });
    if (has_viscosity)
      viscosity = add("pair viscosity");
    if (has_stress)
      stress = add("artificial stress");
    if (!has_viscosity || !model.heat)
      return;
    heat = &this->actions.add_heat("heat of pairs", "pair viscosity heat");
    heat->stays_on_rank();
  }

  template <int dim>
  void PairForces<dim>::add_forces(Model<dim> &, const Clock &, const NodalVector &)
  {
    const NodalState &state = model.state;
    if (viscosity != nullptr)
    {
      double *const force = viscosity->at_all_nodes().data();
      for_parts_with_pairs(
          model,
          [&](const PairInteractions<dim> &pairs, const auto &particles, const std::size_t number)
          {
            power[number].assign(particles.particle_nodes().size(), 0.);
            if (!pairs.pair_terms().has_viscosity())
              return;
            pairs.pair_terms().add_viscous_force(pairs.pair_rows(), state.position.data(),
                                                 state.velocity.data(), force,
                                                 power[number].data());
          });
    }
    if (stress == nullptr)
      return;
    double *const force = stress->at_all_nodes().data();
    for_parts_with_pairs(
        model,
        [&](const PairInteractions<dim> &pairs, const auto &particles, const std::size_t)
        {
          if (pairs.pair_terms().has_artificial_stress())
            pairs.pair_terms().add_artificial_stress(pairs.pair_rows(), particles.points(),
                                                     state.position.data(), force);
        });
  }

  template <int dim>
  void PairForces<dim>::linearize(Model<dim> &, const Clock &, Tangent<dim> &tangent)
  {
    if (viscosity == nullptr || tangent.velocity == nullptr)
      return;
    const NodalState &state = model.state;
    applied.fit_to(state.partition());
    const auto apply = [&](const PairInteractions<dim> &pairs, const auto &, const std::size_t)
    {
      if (pairs.pair_terms().has_viscosity())
        pairs.pair_terms().apply_viscosity(pairs.pair_rows(), state.position.data(),
                                           state.velocity.data(), tangent.velocity->data(),
                                           tangent.factor, applied.data());
    };
    add_up({&applied}, [&] { for_parts_with_pairs(model, apply); });
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      store_node(load_node(tangent.force->node(i)) + load_node(applied.node(i)),
                 tangent.force->node(i));
  }

  template <int dim>
  void PairForces<dim>::after_acceleration(Model<dim> &, const Clock &clock)
  {
    if (heat == nullptr)
      return;
    for_parts_with_pairs(
        model,
        [&](const PairInteractions<dim> &, const auto &particles, const std::size_t k)
        {
          const std::vector<unsigned int> &nodes = particles.particle_nodes();
          for (std::size_t row = 0; row < nodes.size(); ++row)
            heat->add_heat(nodes[row], clock.velocity_step() * power[k][row]);
        });
  }

  template <int dim>
  std::vector<std::string> PairForces<dim>::warnings(const Model<dim> &, const Clock &,
                                                     const typename Process<dim>::Occasion occasion)
  {
    if (occasion != Process<dim>::Occasion::end || viscosity == nullptr ||
        std::none_of(model.parts.begin(), model.parts.end(),
                     [](const Part<dim> &part) { return part.material->relative_inertia() > 1.; }))
      return {};
    double plastic = 0;
    for (const Part<dim> &part : model.parts)
      plastic += part.formulation->energies()["plastic dissipation"];
    plastic = ordered_sum(plastic, model.communicator);
    const double viscous = ordered_sum(-viscosity->work(), model.communicator);
    constexpr double tolerable = 0.05;
    if (plastic == 0. || !(viscous > tolerable * plastic))
      return {};
    std::ostringstream text;
    text.precision(3);
    text << "The artificial viscosity of pairs has taken " << viscous
         << ", more than 5 % of the plastic work " << plastic
         << ". It grows with the speed at which the process is run, and makes forces too large. "
            "Smaller `Artificial viscosity alpha` and `beta`, or less scaling, may help.";
    return {text.str()};
  }

  namespace
  {
    template <int dim>
    class PairForcesKind : public ProcessKind<dim>
    {
    public:
      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        refuse_switch_at_rest<dim>(parameters, parts, "Artificial stress",
                                   "it acts in kernels that follow a motion");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        bool has_forces = false;
        for_parts_with_pairs(
            model,
            [&](const PairInteractions<dim> &pairs, const auto &, const std::size_t)
            {
              has_forces = has_forces || pairs.pair_terms().has_viscosity() ||
                           pairs.pair_terms().has_artificial_stress();
            });
        if (!model.has_mechanics || !has_forces)
          return nullptr;
        return std::make_unique<PairForces<dim>>(model);
      }
    };
  } // namespace

  template class PairForces<2>;
  template class PairForces<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(PairForcesKind, process_order::loads + 2)
} // namespace tombolo
