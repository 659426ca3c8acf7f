// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/model/assembly.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/mechanics/elastic_stiffness.h>

#include <limits>

namespace tombolo
{
  using namespace dealii;

  /**
   * Damping in proportion to the stiffness, by the section `Damping`: the nodal force -β K v with
   * the elastic stiffness K of all parts at the present positions and the velocity v of t_{n-1/2}.
   * A vibration of the angular frequency ω loses energy with the damping ratio β ω/2. It is an
   * internal force: rigid motion is not damped. What it takes is `stiffness damping`.
   *
   * As the force is that of a velocity half a step old, the stable step is shorter: h (√(1 + ξ²) -
   * ξ) with ξ = β/h, where h is the limit without it. The spectral estimate sees the operator
   * itself.
   */
  template <int dim>
  class StiffnessDamping : public Process<dim>
  {
  public:
    /** @p factor is β [T]. */
    explicit StiffnessDamping(const double factor)
        : factor(factor), damping(this->actions.add("stiffness damping", ActsAt::nodes))
    {
      this->roles.rest = ProcessRole::is_idle;
      damping.books("stiffness damping", EnergyKind::dissipated).stays_on_rank();
    }

    void model_changed(const Model<dim> &model) override
    {
      stiffness_force.reinit(model.state.partition());
    }

    void add_forces(const Model<dim> &model, const Clock &, const NodalVector &) override
    {
      NodalVector &force = damping.at_all_nodes();
      apply_stiffness(model, model.state.velocity, force);
      for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          force.node(i)[d] *= -factor;
    }

    void linearize(const Model<dim> &model, const Clock &, Tangent<dim> &tangent) override
    {
      if (tangent.velocity == nullptr)
        return;
      apply_stiffness(model, *tangent.velocity, stiffness_force);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          tangent.force->node(i)[d] += tangent.factor * factor * stiffness_force.node(i)[d];
    }

  private:
    /** @p result := K @p velocity, whose ghosts are current. Collective. */
    void apply_stiffness(const Model<dim> &model, const NodalVector &velocity, NodalVector &result)
    {
      // In a step without end no artificial viscosity is left.
      constexpr double endless = std::numeric_limits<double>::max();
      Assembly<dim>(model.parts)
          .assemble(*model.bridge, velocity, result,
                    [&](const Part<dim> &part, const NodalVector &seen, NodalVector &sum)
                    { add_elastic_stiffness(part, model.state.position, seen, endless, sum); });
    }

    double factor;
    NodalVector stiffness_force; ///< buffer of linearize()
    Action &damping;
  };

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

  TOMBOLO_REGISTER_PROCESS_KIND(StiffnessDampingKind, process_order::loads + 1)
} // namespace tombolo
