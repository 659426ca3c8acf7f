// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/xsph.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/particles/pair_interactions.h>
#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/mechanics/rigid_contacts.h>

#include <cstdint>

namespace tombolo
{
  namespace
  {
    template <int dim>
    bool has_xsph(const ParticleFormulation<dim> &particles)
    {
      const PairInteractions<dim> *const pairs = particles.pairs();
      return pairs != nullptr && pairs->pair_terms().has_xsph();
    }
  } // namespace

  template <int dim>
  void Xsph<dim>::model_changed(Model<dim> &model)
  {
    const auto &partition = model.state.partition();
    mass.reinit(partition, Quantity::scalar);
    momentum.reinit(partition);
    other_force.reinit(partition);
    if (moved.partition() == nullptr)
      moved.reinit(partition);
    else if (moved.partition() != partition)
      moved.move_to(partition);
    for (const ParticleFormulation<dim> *const particles : model.particle_parts())
      if (has_xsph(*particles))
        particles->add_mass(mass);
  }

  template <int dim>
  void Xsph<dim>::add_forces(Model<dim> &, const Clock &, const NodalVector &force)
  {
    other_force.copy_from(force);
  }

  template <int dim>
  void Xsph<dim>::constrain_acceleration(Model<dim> &model, const Clock &)
  {
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
      {
        // What contacts, and processes that a scene names, have added.
        double &force = other_force.node(i)[d];
        force = model.state.force.node(i)[d] - force;
        in_contacts += 0.5 * force * moved.node(i)[d];
      }
  }

  template <int dim>
  void Xsph<dim>::after_motion(Model<dim> &model, const Clock &clock)
  {
    NodalState &state = model.state;
    if (model.bridge->operators() != Bridge::Operators::identity)
      state.unsmoothed_velocity.update_ghosts(); // those who smooth read owned values only
    const auto add = [&]
    {
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
        if (has_xsph(*particles))
          particles->pairs()->pair_terms().add_exchanged_momentum(
              particles->pairs()->pair_rows(), state.position.data(),
              state.unsmoothed_velocity.data(), momentum.data());
    };
    add_up({&momentum}, add);
    moved.set_zero();
    const std::vector<std::uint8_t> &constrained = model.conditions->constrained_components();
    // A spring of contact stores energy by the position, which only the velocity can pay for.
    const auto *const contacts = model.template find_process<RigidContacts<dim>>();
    state.position.fill(
        [&](const unsigned int i, double *const place)
        {
          if (*mass.node(i) == 0. || *model.element_mass.node(i) > 0. ||
              (contacts != nullptr && contacts->nodal_force(i).norm_square() != 0.))
            return;
          const double scale = clock.next_step / *mass.node(i);
          const std::uint8_t fixed = constrained.empty() ? std::uint8_t(0) : constrained[i];
          for (unsigned int d = 0; d < dim; ++d)
            if (((fixed >> d) & 1u) == 0)
            {
              const double added = scale * momentum.node(i)[d];
              place[d] += added;
              work += added * state.force.node(i)[d];
              moved.node(i)[d] = added;
              in_contacts += 0.5 * other_force.node(i)[d] * added;
            }
        });
    model.bridge->positions_have_changed();
  }

  template <int dim>
  void Xsph<dim>::account(EnergyAccounts &accounts) const
  {
    accounts.add("XSPH in contacts", EnergyKind::artificial, in_contacts);
  }

  template <int dim>
  void Xsph<dim>::report(const Model<dim> &model, TimeTable &table) const
  {
    table.add("XSPH work", "M L^2/T^2", ordered_sum(work, model.communicator));
  }

  namespace
  {
    template <int dim>
    class XsphKind : public ProcessKind<dim>
    {
    public:
      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        if (!model.has_mechanics)
          return nullptr;
        for (const ParticleFormulation<dim> *const particles : model.particle_parts())
          if (has_xsph(*particles))
            return std::make_unique<Xsph<dim>>();
        return nullptr;
      }
    };
  } // namespace

  template class Xsph<2>;
  template class Xsph<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(XsphKind, process_order::contact - 1)
} // namespace tombolo
