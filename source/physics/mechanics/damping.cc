// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/boundary/limited_function.h>
#include <tombolo/model/model.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/process.h>
#include <tombolo/model/tangent.h>
#include <tombolo/physics/mechanics/rigid_bodies.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>
#include <tombolo/physics/mechanics/surface_damping.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    constexpr const char *damping_section = "Damping";
  } // namespace

  /**
   * Damping in proportion to the mass, by the section `Damping`: the nodal force -α m v, with the
   * velocity v in the middle of Δt_n, so that the stable step is that without damping. It is a
   * force from outside, as of a fluid at rest: its impulse counts as one, and its dissipation is
   * `mass damping`. Where the motion is not that of the node alone, prescribed or of a rigid part,
   * v is that of half a step before.
   */
  template <int dim>
  class Damping : public Process<dim>
  {
  public:
    /** @p rate is α, a function of time [1/T]. */
    explicit Damping(LimitedFunction<dim> rate)
        : rate(std::move(rate)), damping(this->actions.add("damping", ActsAt::nodes))
    {
      this->roles.rest = ProcessRole::is_idle;
      damping.books("mass damping", EnergyKind::dissipated)
          .comes_from_outside()
          .follows_acceleration()
          .stays_on_rank();
    }

    void model_changed(const Model<dim> &model) override
    {
      is_rigid.clear();
      for (unsigned int part = 0; part < model.parts.size(); ++part)
        if (rigid_cells(model.parts[part]) != nullptr)
        {
          is_rigid.resize(model.state.partition()->n_owned());
          for (const unsigned int node : owned_nodes_of_part(model, part))
            is_rigid[node] = true;
        }
    }

    void constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                NodalState &state) override
    {
      const double alpha = rate.value(Point<dim>(), clock.time);
      const double step = clock.velocity_step();
      const auto &constrained = model.conditions->constrained_components();
      NodalVector &force = damping.at_all_nodes();
      for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      {
        if (!(*model.bridge->mass().node(i) > 0.)) // all its cells were removed
          continue;
        const double *const mass = model.bridge->nodal_mass().node(i);
        const bool moves_with_others = !is_rigid.empty() && is_rigid[i];
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double velocity = state.velocity.node(i)[d];
          const double acceleration = state.acceleration.node(i)[d];
          if (moves_with_others || (!constrained.empty() && ((constrained[i] >> d) & 1u)))
            force.node(i)[d] = -alpha * mass[d] * velocity;
          else
          {
            const double damped = (acceleration - alpha * velocity) / (1. + 0.5 * alpha * step);
            force.node(i)[d] = mass[d] * (damped - acceleration);
          }
        }
      }
    }

    static void declare_parameters(Parameters &parameters)
    {
      Entries(parameters.handler())
          .subsection(damping_section)
          .text("Rate", "0", "1/T",
                "α of the force -α m v on all nodes, which takes the motion of a body to rest: 2 ω "
                "damps a vibration of the angular frequency ω critically. A function of t, so that "
                "it can end; 0: there is no damping.");
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      const Section section = parameters.section(damping_section);
      read(section);
      // Without parts nothing can be checked.
      if (section.is_set("Rate") && !parts.empty() &&
          std::none_of(parts.begin(), parts.end(), has_motion<dim>))
        section.fail("Rate", "the scene has no mechanics, since its materials have no stresses; "
                             "nothing moves.");
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const Section section = parameters.section(damping_section);
      if (!model.has_mechanics || section.get("Rate") == "0")
        return nullptr;
      return std::make_unique<Damping>(read(section));
    }

  private:
    static LimitedFunction<dim> read(const Section &section)
    {
      LimitedFunction<dim> rate(section, "Rate", 0., std::numeric_limits<double>::max(),
                                "a number of at least 0");
      if (rate.depends_on_position())
        section.fail("Rate", "allowed is a function of t alone.");
      return rate;
    }

    LimitedFunction<dim> rate;
    std::vector<bool> is_rigid; ///< owned nodes; empty without rigid parts
    Action &damping;
  };

  /**
   * Damping in proportion to the stiffness, by the section `Damping`: the nodal force -β K v with
   * the elastic stiffness K of all parts at the present positions and the velocity v of t_{n-1/2}.
   * A vibration of the angular frequency ω loses energy with the damping ratio β ω/2. It is an
   * internal force: rigid motion is not damped. Its dissipation is `stiffness damping`.
   *
   * As the force is that of a velocity half a step old, the stable step is shorter: h (√(1 + ξ²) -
   * ξ) with ξ = β/h, where h is the limit without it. The spectral estimate includes the operator
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
      apply_elastic_stiffness(model, model.state.velocity, endless, force);
      for (unsigned int i = 0; i < force.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          force.node(i)[d] *= -factor;
    }

    void linearize(const Model<dim> &model, const Clock &, Tangent<dim> &tangent) override
    {
      if (tangent.velocity == nullptr)
        return;
      apply_elastic_stiffness(model, *tangent.velocity, endless, stiffness_force);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          tangent.force->node(i)[d] += tangent.factor * factor * stiffness_force.node(i)[d];
    }

    static void declare_parameters(Parameters &parameters)
    {
      read(Entries(parameters.handler()).subsection(damping_section));
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      const Section section = parameters.section(damping_section);
      read(section);
      if (section.is_set(factor_entry) && !parts.empty() &&
          std::none_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return part.material->has_mechanics(); }))
        section.fail(factor_entry, "the scene has no mechanics, since its materials have no "
                                   "stresses; nothing moves.");
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const double factor = read(parameters.section(damping_section));
      if (!model.has_mechanics || factor == 0.)
        return nullptr;
      return std::make_unique<StiffnessDamping>(factor);
    }

  private:
    static constexpr const char *factor_entry = "Stiffness factor";
    static double read(const Entries &e)
    {
      return e.number(
          factor_entry, "0", at_least(0.), "T",
          "β of the force -β K v with the elastic stiffness K, which damps what deforms and "
          "leaves rigid motion alone: a vibration of the angular frequency ω has the "
          "damping ratio β ω/2. The stable step becomes shorter: by 1/(√(1 + ξ²) + ξ), "
          "where ξ is β over the step without it. 0: there is none.");
    }

    /** In a step without end no artificial viscosity is left. */
    static constexpr double endless = std::numeric_limits<double>::max();

    double factor;
    NodalVector stiffness_force; ///< buffer of linearize()
    Action &damping;
  };

  TOMBOLO_REGISTER_PROCESS(Damping, process_order::damping)
  TOMBOLO_REGISTER_PROCESS(StiffnessDamping, process_order::loads + 1)
  TOMBOLO_REGISTER_PROCESS(SurfaceDamping, process_order::damping)
} // namespace tombolo
