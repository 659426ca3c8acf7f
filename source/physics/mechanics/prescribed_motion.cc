// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/clock.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/model/internal_power.h>
#include <tombolo/model/model.h>
#include <tombolo/output/output.h>
#include <tombolo/physics/mechanics/condition_accounts.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  template <int dim>
  class MechanicalConditions;

  namespace
  {
    /** A prescribed component of a constrained node, or an axis of its frame that is none. */
    struct PrescribedAxis
    {
      std::size_t k;             ///< index in the list of constrained nodes
      unsigned int node;         ///< owned
      unsigned int d;            ///< the component, or the index of the axis
      const ObliqueNode *turned; ///< null for a component

      double along(const double *const vector) const
      {
        if (turned == nullptr)
          return vector[d];
        double result = 0;
        for (unsigned int e = 0; e < 3; ++e)
          result += turned->axes[d][e] * vector[e];
        return result;
      }

      std::array<double, 3> times(const double length) const
      {
        std::array<double, 3> result{};
        for (unsigned int e = 0; e < 3; ++e)
          result[e] = turned != nullptr ? length * turned->axes[d][e] : e == d ? length : 0.;
        return result;
      }
    };

    /** The inertial force m a of a node. */
    template <int dim>
    std::array<double, 3> inertial_force(const Model<dim> &model, const unsigned int node)
    {
      std::array<double, 3> result{};
      for (unsigned int d = 0; d < 3; ++d)
        result[d] =
            model.bridge->nodal_mass().node(node)[d] * model.state.acceleration.node(node)[d];
      return result;
    }

    /** Calls @p action with each prescribed axis, the velocity along it at t_{n-1/2} on which
     * forces do work, which is prescribed, and that by S alone, on which the inertia does work. Not
     * for nodes without mass, whose nodal_mass() is a divisor only: hanging ones, and those of
     * cells that were removed. */
    template <int dim, typename Action>
    void for_constrained(const Model<dim> &model, const Action &action)
    {
      const auto &nodes = model.conditions->constrained_nodes();
      const auto &constrained = model.conditions->constrained_components();
      const auto &particles = model.bridge->get_constrained_particles().particles();
      auto smoothed = particles.begin();
      for (std::size_t k = 0; k < nodes.size(); ++k)
      {
        const unsigned int node = nodes[k];
        if (!(*model.bridge->mass().node(node) > 0.))
          continue;
        while (smoothed != particles.end() && smoothed->node < node)
          ++smoothed;
        const bool is_particle = smoothed != particles.end() && smoothed->node == node;
        for (unsigned int d = 0; d < 3; ++d)
        {
          if (!((constrained[node] >> d) & 1u))
            continue;
          const double velocity = model.state.velocity.node(node)[d];
          action(PrescribedAxis{k, node, d, nullptr}, velocity,
                 is_particle ? smoothed->smoothed_velocity[d] : velocity);
        }
        const ObliqueNode *const oblique = model.conditions->oblique_nodes().find(node);
        for (unsigned int d = 0; oblique != nullptr && d < 3; ++d)
          if (((oblique->prescribed & ~constrained[node]) >> d) & 1u)
          {
            const PrescribedAxis axis{k, node, d, oblique};
            const double velocity = axis.along(model.state.velocity.node(node));
            action(axis, velocity, velocity);
          }
      }
    }

    /** Calls @p action with the index in the list of constrained nodes, the component and the
     * particle, for each prescribed component of smoothed particles. */
    template <int dim, typename Action>
    void for_particles(const Model<dim> &model, const Action &action)
    {
      const std::vector<unsigned int> &nodes = model.conditions->constrained_nodes();
      auto k = nodes.begin();
      for (const ConstrainedParticle &particle :
           model.bridge->get_constrained_particles().particles())
      {
        k = std::lower_bound(k, nodes.end(), particle.node);
        for (unsigned int d = 0; d < 3; ++d)
          if ((particle.components >> d) & 1u)
            action(static_cast<std::size_t>(k - nodes.begin()), d, particle);
      }
    }

    template <int dim>
    unsigned int condition_of(const MechanicalConditions<dim> &conditions,
                              const std::size_t constrained_node, const unsigned int component)
    {
      return static_cast<unsigned int>(
          conditions.prescribing_condition(constrained_node, component));
    }
  } // namespace

  /**
   * Components of the motion that conditions prescribe: their acceleration, and work and impulse of
   * the reactions m a - F that hold them. The work of the step from t_{n-1} to t_n is that of the
   * reactions at both ends on v_{n-1/2}. Impulse and work of each condition are kept besides the
   * sums. With affine smoothing, whose angular momentum is that about x̂, the reactions have a
   * further moment: ConstrainedParticles::find_moments().
   *
   * What is prescribed is not smoothed: where a condition begins or ceases to act at t_n, S becomes
   * S'. Inertia does half of the work of the forces at t_{n-1} on S v̂_{n-1/2}, and that of the
   * forces at t_n on S' v̂_{n-1/2}. Particles whose positions move with S v̂ strain by it, so that
   * the condition does the work ½ Δt_n F_n (S' - S) v̂. Others strain by S' v̂: it does that of the
   * internal forces at t_{n-1} on the same difference.
   */
  template <int dim>
  class PrescribedMotion : public Process<dim>
  {
  public:
    explicit PrescribedMotion(Model<dim> &model)
        : model(model), conditions(*model.conditions), supports(model, true)
    {
      const auto vector = [](Vector & values) -> auto &
      {
        return values;
      };
      const std::vector<unsigned int> &nodes = conditions.constrained_nodes();
      this->structure.archived(
          [this](StateArchive &archive)
          {
            if (conditions.are_timed())
              archive("conditions act since", acting_since);
            if (conditions.are_timed() && archive.is_reading())
              this->model.conditions->act_at(acting_since);
          });
      Records &all = this->records.group("prescribed motion");
      all.sums("work", work);
      all.at_nodes(nodes, previous_inertia).vector("previous inertia", vector);
      all.at_nodes(nodes, previous_force).vector("previous force", vector);
      all.archived([this](StateArchive &archive) { serialize_offsets(archive); });
      supports.list(all);
      model.signals.change.connect([this] { prepare_change(); });
      this->observed.energy("external work", EnergyKind::external, work);
      this->observed.views.connect(
          [this](OutputView<dim> &view)
          { view.reaction = [this](const unsigned int node) { return reaction(node); }; });
      this->observed.history(condition_history, [this](BalanceHistory<dim> &row)
                             { add_condition_columns(supports.balances(), row); });
    }

    ModelChange change_model(Model<dim> &changed, const Clock &clock) override
    {
      ModelChange change;
      if (!conditions.will_change(clock.time))
        return change;
      changed.begin_change();
      const double step = clock.previous_step;
      const auto operators = changed.bridge->operators();
      const bool smooths = step > 0. && operators != Bridge::Operators::identity;
      const double power =
          smooths && operators != Bridge::Operators::affine ? internal_power(changed, step) : 0.;
      const NodalVector velocity_before = changed.state.velocity.copy();
      condition_of_change = first_to_change(clock.time);
      acting_since = clock.time;
      changed.conditions->act_at(acting_since);
      changed.conditions->set_partition(*changed.state.partition());
      changed.renew_inertia();
      if (smooths && operators == Bridge::Operators::affine)
      {
        // Particles strain as they have moved.
        changed.bridge->move_with_smoothed_velocity(changed.state, 0.);
        velocity_after = changed.state.velocity.copy();
        changed.state.velocity.copy_from(velocity_before);
      }
      else if (smooths)
      {
        changed.bridge->smooth_velocity(changed.state);
        add_work_of_change(
            -energy_of_change(power, internal_power(changed, step), step, changed.communicator));
      }
      change.masses = true;
      return change;
    }

    void add_forces(const Model<dim> &, const Clock &, const NodalVector &force) override
    {
      for (unsigned int i = 0; changes_velocity() && i < force.partition()->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          power_of_change +=
              force.node(i)[d] * (velocity_after.node(i)[d] - model.state.velocity.node(i)[d]);
      if (const Refusal found = refusal(model); !found.reason.empty())
        this->failure = "condition \"" + conditions.all()[found.condition].name +
                        "\", entry \"Axes\": " + found.reason;
    }

    void constrain_acceleration(const Model<dim> &, const Clock &clock, NodalState &state) override
    {
      conditions.prescribe_acceleration(state, clock.time, clock.velocity_step(), clock.next_step);
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      const NodalState &state = model.state;
      const std::vector<unsigned int> &nodes = conditions.constrained_nodes();
      const double velocity_step = clock.velocity_step();
      supports.begin_step(clock.velocity_time());
      if (changes_velocity())
      {
        add_work_of_change(0.5 * velocity_step * std::exchange(power_of_change, 0.));
        model.state.velocity = std::exchange(velocity_after, NodalVector());
      }
      if (previous_inertia.size() != nodes.size())
      {
        previous_inertia.assign(nodes.size(), {});
        previous_force.assign(nodes.size(), {});
      }
      for_constrained(
          model,
          [&](const PrescribedAxis &axis, const double velocity, const double inertial_velocity)
          {
            const unsigned int node = axis.node;
            const double inertia = velocity_step * axis.along(inertial_force(model, node).data());
            const double force = velocity_step * axis.along(state.force.node(node));
            const unsigned int condition = condition_of(conditions, axis.k, axis.d);
            const double step_work =
                inertial_velocity *
                    impulse_of_step(inertia, previous_inertia[axis.k][axis.d], clock) -
                velocity * impulse_of_step(force, previous_force[axis.k][axis.d], clock);
            work += step_work;
            supports[condition].work += step_work;
            const Vector reaction = axis.times(inertia - force);
            model.impulses.add(state.position.node(node), reaction);
            supports[condition].impulses.add(state.position.node(node), reaction);
          });
      add_moments(velocity_step);
    }

    void after_motion(const Model<dim> &, const Clock &, NodalState &) override
    {
      for_particles(
          model,
          [&](const std::size_t k, const unsigned int d, const ConstrainedParticle &particle)
          {
            const ConstraintReaction &reaction = particle.reactions[d];
            auto &account = supports[condition_of(conditions, k, d)];
            account.impulses.add_now(reaction.impulse, reaction.angular_impulse);
            account.work += reaction.work;
          });
      const ConstraintReaction reaction = model.bridge->extract_constraint_reaction();
      work += reaction.work;
      model.impulses.add_now(reaction.impulse, reaction.angular_impulse);
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      if (!model.has_mechanics || !model.conditions->has_constraints())
        return nullptr;
      auto result = std::make_unique<PrescribedMotion>(model);
      const Refusal rank_refusal = first_refusal(model);
      const unsigned int first = Utilities::MPI::min(rank_refusal.condition, model.communicator);
      if (first == numbers::invalid_unsigned_int)
        return result;
      parameters.section("Condition: " + model.conditions->all()[first].name)
          .fail("Axes", first_text(model.communicator,
                                   rank_refusal.condition == first ? rank_refusal.reason : ""));
    }

  private:
    using Vector = std::array<double, 3>;

    /** Why nodes can not be held along directions that are no axes of the coordinates, and by which
     * condition; empty where they can. */
    struct Refusal
    {
      unsigned int condition = numbers::invalid_unsigned_int;
      std::string reason;
    };

    /** The first one at any time of the run, on this rank. Collective. */
    static Refusal first_refusal(Model<dim> &model)
    {
      Refusal result;
      const auto check_at = [&](const double time)
      {
        model.conditions->act_at(time);
        model.conditions->set_partition(*model.state.partition());
        for (const Refusal &found : {refusal_by_images(model), refusal(model)})
          if (result.reason.empty())
            result = found;
      };
      for (const MechanicalCondition<dim> &condition : model.conditions->all())
        for (const double time : {condition.start, condition.end})
          if (std::isfinite(time))
            check_at(time);
      check_at(0.);
      return result;
    }

    static Refusal refused(const Model<dim> &model, const ObliqueNode &at,
                           const std::string &reason)
    {
      const std::vector<unsigned int> &nodes = model.conditions->constrained_nodes();
      const auto k = static_cast<std::size_t>(
          std::lower_bound(nodes.begin(), nodes.end(), at.node) - nodes.begin());
      for (unsigned int d = 0; d < dim; ++d)
        if (((at.prescribed >> d) & 1u) && at.axes[d][d] != 1.)
          return {condition_of(*model.conditions, k, d), reason};
      return {};
    }

    /** Directions along which images restrict the motion of nodes in part. Now, on this rank.
     * Collective. */
    static Refusal refusal_by_images(const Model<dim> &model)
    {
      const std::vector<ObliqueNode> &oblique = model.conditions->oblique_nodes().all();
      Refusal result;
      NodalVector direction(model.state.partition());
      for (unsigned int k = 0; k < dim; ++k)
      {
        direction.set_zero();
        for (const ObliqueNode &at : oblique)
          for (unsigned int d = 0; d < dim && ((at.prescribed >> k) & 1u); ++d)
            direction.node(at.node)[d] = at.axes[k][d];
        direction.make_symmetric();
        for (const ObliqueNode &at : oblique)
        {
          const double *const left = direction.node(at.node);
          const double length = std::hypot(left[0], left[1], left[2]);
          if (length > 1e-9 && length < 1. - 1e-9 && result.reason.empty())
            result =
                refused(model, at,
                        "it holds a node on a plane, beyond which the body is its own mirror "
                        "image, along a direction that is neither in the plane nor normal to it. "
                        "`Where` can leave out the nodes on the plane.");
        }
      }
      return result;
    }

    /** Now, on this rank. */
    static Refusal refusal(const Model<dim> &model)
    {
      for (const ObliqueNode &at : model.conditions->oblique_nodes().all())
        if (model.bridge->mass_split().n_particle_parts[at.node] > 0)
          return refused(model, at,
                         "it leaves directions of particles free, or to other conditions, and "
                         "smoothing treats the components of particles by the axes of the "
                         "coordinates. Allowed are nodes of elements, all components, or axes "
                         "of the coordinates.");
      return {};
    }

    /** Whether nodes will have another smoothed velocity than that by which they have moved. */
    bool changes_velocity() const
    {
      return velocity_after.partition() != nullptr;
    }

    void add_work_of_change(const double change)
    {
      work += change;
      supports[condition_of_change].work += change;
    }

    /** The first condition that begins or ceases to act at @p time; there is one. */
    unsigned int first_to_change(const double time) const
    {
      const auto &all = conditions.all();
      const auto found =
          std::find_if(all.begin(), all.end(),
                       [&](const MechanicalCondition<dim> &condition)
                       {
                         return prescribes(condition.type) &&
                                condition.acts_at(time) != condition.acts_at(acting_since);
                       });
      return static_cast<unsigned int>(found - all.begin());
    }

    /** Accounts for the first half of the step with the former nodes and masses. */
    void prepare_change()
    {
      if (previous_inertia.size() == conditions.constrained_nodes().size())
        for_constrained(
            model,
            [&](const PrescribedAxis &axis, const double velocity, const double inertial_velocity)
            {
              const double half = 0.5 * (inertial_velocity * previous_inertia[axis.k][axis.d] -
                                         velocity * previous_force[axis.k][axis.d]);
              work += half;
              supports[condition_of(conditions, axis.k, axis.d)].work += half;
            });
      previous_inertia.clear();
      previous_force.clear();
    }

    /** Adds the moment of the reactions of prescribed components of particles. Collective. */
    void add_moments(const double velocity_step)
    {
      if (model.bridge->operators() != Bridge::Operators::affine)
        return;
      model.bridge->get_constrained_particles().find_moments(model.state);
      for_particles(
          model,
          [&](const std::size_t k, const unsigned int d, const ConstrainedParticle &particle)
          {
            const Vector &moment = particle.moments[d];
            model.impulses.add(Vector{}, moment, velocity_step);
            supports[condition_of(conditions, k, d)].impulses.add(Vector{}, moment, velocity_step);
          });
    }

    void serialize_offsets(StateArchive &archive) const
    {
      if (model.bridge->operators() != Bridge::Operators::affine)
        return;
      std::vector<Vector> offsets(conditions.constrained_nodes().size(), Vector{});
      for_particles(
          model, [&](const std::size_t k, const unsigned int, const ConstrainedParticle &particle)
          { offsets[k] = particle.offset; });
      archive.nodal("offset from smoothed position", conditions.constrained_nodes(), offsets);
      if (!archive.is_reading())
        return;
      auto k = conditions.constrained_nodes().begin();
      for (ConstrainedParticle &particle : model.bridge->get_constrained_particles().particles())
      {
        k = std::lower_bound(k, conditions.constrained_nodes().end(), particle.node);
        particle.offset = offsets[std::size_t(k - conditions.constrained_nodes().begin())];
      }
    }

    /** m a - F of the prescribed components of an owned node [M L/T^2]. */
    Vector reaction(const unsigned int node) const
    {
      Vector result{};
      const auto &constrained = conditions.constrained_components();
      const bool has_mass = node < constrained.size() && *model.bridge->mass().node(node) > 0.;
      for (unsigned int d = 0; d < 3 && has_mass; ++d)
        if ((constrained[node] >> d) & 1u)
          result[d] =
              model.bridge->nodal_mass().node(node)[d] * model.state.acceleration.node(node)[d] -
              model.state.force.node(node)[d];
      const ObliqueNode *const oblique = conditions.oblique_nodes().find(node);
      if (oblique == nullptr || !has_mass)
        return result;
      // All prescribed axes: free components along the frame are removed.
      result = inertial_force(model, node);
      for (unsigned int d = 0; d < 3; ++d)
        result[d] -= model.state.force.node(node)[d];
      Vector free = result;
      oblique->remove_prescribed(free.data());
      for (unsigned int d = 0; d < 3; ++d)
        result[d] -= free[d];
      return result;
    }

    Model<dim> &model;
    const MechanicalConditions<dim> &conditions;
    double acting_since = 0;              ///< the conditions of which time act [T]
    double work = 0;                      ///< this rank's share [M L^2/T^2]
    ConditionAccounts<dim> supports;      ///< the same by condition, and impulses
    std::vector<Vector> previous_inertia; ///< Δt_{n-1} m a at constrained nodes
    std::vector<Vector> previous_force;   ///< Δt_{n-1} F at constrained nodes
    unsigned int condition_of_change = 0; ///< the condition that began or ceased to act
    NodalVector velocity_after;           ///< S v̂ of the conditions that act now; else none
    double power_of_change = 0;           ///< of F on its difference to that of before
  };

  TOMBOLO_REGISTER_PROCESS(PrescribedMotion, process_order::prescribed_motion)
} // namespace tombolo
