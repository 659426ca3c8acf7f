// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/fragment_contact.h>

#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Of the parts whose fragments feel each other. */
    template <int dim>
    std::vector<SelfContact<dim> *> contacts_of(const Model<dim> &model)
    {
      std::vector<SelfContact<dim> *> result;
      for (ParticleFormulation<dim> *const particles : model.particle_parts())
        if (SelfContact<dim> *const contact = particles->fragment_contact())
          result.push_back(contact);
      return result;
    }

    /** The sum over parts and ranks. Collective. */
    template <int dim>
    FragmentCounts sum_of_counts(const Model<dim> &model)
    {
      FragmentCounts sum;
      for (const SelfContact<dim> *const contact : contacts_of(model))
      {
        sum.n_fragments += contact->counts().n_fragments;
        sum.n_touching += contact->counts().n_touching;
      }
      sum.n_fragments = Utilities::MPI::sum(sum.n_fragments, model.communicator);
      sum.n_touching = Utilities::MPI::sum(sum.n_touching, model.communicator);
      return sum;
    }

    template <int dim>
    bool has_friction(const Model<dim> &model)
    {
      const auto contacts = contacts_of(model);
      return std::any_of(contacts.begin(), contacts.end(),
                         [](const auto *contact) { return contact->rubs(); });
    }
  } // namespace

  template <int dim>
  FragmentContact<dim>::FragmentContact(const Model<dim> &model)
      : model(model), revision_of_cells(model.revisions.cells), rubs(has_friction(model)),
        forces(this->actions.add("contact of fragments", ActsAt::positions))
  {
    if (!rubs)
      forces.stays_on_rank();
    this->observed.step_limits.connect(
        [&](const double stable_step, double &fraction)
        {
          for (const SelfContact<dim> *const contact : contacts_of(model))
            fraction = std::min(fraction, contact->stable_fraction(stable_step));
        });
    this->observed.column("fragments", "1",
                          [&] { return static_cast<double>(sum_of_counts(model).n_fragments); });
    this->observed.column("particles in self-contact", "1",
                          [&] { return static_cast<double>(sum_of_counts(model).n_touching); });
    this->observed.result("fragments", [&] { return sum_of_counts(model).n_fragments; });
    if (!rubs || !model.heat)
      return;
    heat = &this->actions.add_heat("heat of fragments", "self-contact friction heat");
    heat->stays_on_rank();
  }

  template <int dim>
  void FragmentContact<dim>::add_forces(const Model<dim> &, const Clock &clock, const NodalVector &)
  {
    const MechanicalInput input{&model.state.position, &model.state.velocity, clock.previous_step};
    FragmentHeat of_nodes;
    if (heat != nullptr)
      of_nodes = {&model.heat->state.present_temperature, &model.heat->nodal_enthalpy,
                  &model.heat->state.pending, heat};
    NodalVector &loads = rubs ? forces.at_all_nodes() : forces.at_touched_nodes();
    for (ParticleFormulation<dim> *const particles : model.particle_parts())
      if (SelfContact<dim> *const contact = particles->fragment_contact())
      {
        if (revision_of_cells != model.revisions.cells)
          contact->forget_fragments();
        contact->add_forces(input, model.element_mass, particles->stencils(), particles->points(),
                            loads, forces.touched_nodes(), of_nodes);
      }
    revision_of_cells = model.revisions.cells;
  }

  namespace
  {
    template <int dim>
    class FragmentContactKind : public ProcessKind<dim>
    {
    public:
      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        refuse_switch_at_rest<dim>(parameters, parts, "Self-contact",
                                   "it acts between fragments that move");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &, Model<dim> &model) const override
      {
        return contacts_of(model).empty() ? nullptr : std::make_unique<FragmentContact<dim>>(model);
      }
    };
  } // namespace

  template class FragmentContact<2>;
  template class FragmentContact<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(FragmentContactKind, process_order::fragment_contact)
} // namespace tombolo
