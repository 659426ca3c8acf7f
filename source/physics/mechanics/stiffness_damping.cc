// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/stiffness_damping.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/mechanics/elastic_stiffness.h>

#include <limits>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  StiffnessDamping<dim>::StiffnessDamping(const double factor)
      : factor(factor), damping(this->actions.add("stiffness damping", ActsAt::nodes))
  {
    this->roles.rest = ProcessRole::is_idle;
    damping.books("stiffness damping", EnergyKind::dissipated).stays_on_rank();
  }

  template <int dim>
  void StiffnessDamping<dim>::model_changed(Model<dim> &model)
  {
    stiffness_force.reinit(model.state.partition());
  }

  template <int dim>
  void StiffnessDamping<dim>::apply_stiffness(const Model<dim> &model, const NodalVector &velocity,
                                              NodalVector &result)
  {
    // In a step without end no artificial viscosity is left.
    constexpr double endless = std::numeric_limits<double>::max();
    Assembly<dim>(model.parts)
        .assemble(*model.bridge, velocity, result,
                  [&](const Part<dim> &part, const NodalVector &seen, NodalVector &sum)
                  { add_elastic_stiffness(part, model.state.position, seen, endless, sum); });
  }

  template <int dim>
  void StiffnessDamping<dim>::add_forces(Model<dim> &model, const Clock &, const NodalVector &)
  {
    NodalVector &force = damping.at_all_nodes();
    apply_stiffness(model, model.state.velocity, force);
    for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        force.node(i)[d] *= -factor;
  }

  template <int dim>
  void StiffnessDamping<dim>::linearize(Model<dim> &model, const Clock &, Tangent<dim> &tangent)
  {
    if (tangent.velocity == nullptr)
      return;
    apply_stiffness(model, *tangent.velocity, stiffness_force);
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        tangent.force->node(i)[d] += tangent.factor * factor * stiffness_force.node(i)[d];
  }

  namespace
  {
    constexpr const char *factor_entry = "Stiffness factor";

    template <int dim>
    class StiffnessDampingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        const Entries e = Entries(parameters.handler()).subsection("Damping");
        e.number(factor_entry, "0", at_least(0.), "T",
                 "β of the force -β K v with the elastic stiffness K, which damps what deforms and "
                 "leaves rigid motion alone: a vibration of the angular frequency ω has the "
                 "damping ratio β ω/2. The stable step becomes shorter: by 1/(√(1 + ξ²) + ξ), "
                 "where ξ is β over the step without it. 0: there is none.");
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        const Section section = parameters.section("Damping");
        section.get_double(factor_entry);
        bool has_mechanics = false;
        for (const Part<dim> &part : parts)
          has_mechanics = has_mechanics || part.material->has_mechanics();
        if (section.is_set(factor_entry) && !has_mechanics)
          section.fail(factor_entry, "the scene has no mechanics, since its materials have no "
                                     "stresses; nothing moves.");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const double factor = parameters.section("Damping").get_double(factor_entry);
        if (!model.has_mechanics || factor == 0.)
          return nullptr;
        return std::make_unique<StiffnessDamping<dim>>(factor);
      }
    };
  } // namespace

  template class StiffnessDamping<2>;
  template class StiffnessDamping<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(StiffnessDampingKind, process_order::loads + 1)
} // namespace tombolo
