// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/fragment_contact.h>

#include <tombolo/model/model.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The sum over parts and ranks. Collective. */
    template <int dim>
    FragmentCounts sum_of_counts(const Model<dim> &model)
    {
      FragmentCounts sum;
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
      {
        const FragmentCounts counts = particles->fragment_counts();
        sum.n_fragments += counts.n_fragments;
        sum.n_touching += counts.n_touching;
      }
      sum.n_fragments = Utilities::MPI::sum(sum.n_fragments, model.communicator);
      sum.n_touching = Utilities::MPI::sum(sum.n_touching, model.communicator);
      return sum;
    }

    template <int dim>
    bool has_contact(const Model<dim> &model)
    {
      const auto particles = model.particle_parts();
      return std::any_of(particles.begin(), particles.end(),
                         [](const auto *part) { return part->fragment_counts().has_contact; });
    }

    template <int dim>
    bool has_friction(const Model<dim> &model)
    {
      const auto particles = model.particle_parts();
      return std::any_of(particles.begin(), particles.end(),
                         [](const auto *part) { return part->fragment_counts().rubs; });
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
          for (const ParticleFormulation<dim> *const particles : model.particle_parts())
            fraction = std::min(fraction, particles->stable_fraction(stable_step));
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
    {
      if (revision_of_cells != model.revisions.cells)
        particles->forget_fragments();
      particles->add_self_contact(input, model.element_mass, loads, forces.touched_nodes(),
                                  of_nodes);
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
        return has_contact(model) ? std::make_unique<FragmentContact<dim>>(model) : nullptr;
      }
    };
  } // namespace

  template class FragmentContact<2>;
  template class FragmentContact<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(FragmentContactKind, process_order::fragment_contact)
} // namespace tombolo
