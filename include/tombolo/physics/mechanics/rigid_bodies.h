// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/initial_condition.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/rigid_body.h>
#include <tombolo/physics/remeshing/model_content.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The owned nodes of the cells of a part, ascending local numbers. */
  template <int dim>
  std::vector<unsigned int> owned_nodes_of_part(const Model<dim> &model, unsigned int part);

  /** A rigid body: the parts of cells that common nodes join, the first of which is the one whose
   * section prescribes the motion, and their owned nodes, ascending local numbers. */
  struct JoinedParts
  {
    std::vector<unsigned int> parts, nodes;
  };

  /** The rigid bodies of a model, whose parts have the sections @p sections. Throws the InputError
   * of a body whose motion is prescribed by two parts. Collective. */
  template <int dim>
  std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &sections,
                                             const Model<dim> &model);

  /** The inertia of a body: that of its cells, and the masses that other parts have at shared
   * nodes. Collective. */
  template <int dim>
  RigidInertia inertia_of(const JoinedParts &body, const Model<dim> &model);

  /** Adds the columns of a body to the table `rigid_bodies.csv`. */
  template <int dim>
  void add_rigid_body_columns(const RigidBodyBalance &now, BalanceHistory<dim> &row);

  /** Refuses scenes in which the nodes of a body, whose section is @p section, cannot move as a
   * rigid body: nodes shared with particles or cells that become such, nodes that depend on nodes
   * of other parts, conditions and contacts that move its nodes one by one, motion out of a plane
   * of symmetry. Leaves out of @p body the nodes that depend on others. Throws InputError.
   * Collective.
   */
  template <int dim>
  void check_rigid_body(const Section &section, const RigidBodySettings<dim> &motion,
                        const Model<dim> &model, JoinedParts &body);

  /**
   * The parts with `Formulation = rigid`. All forces act on their nodes as on any others; when they
   * are complete, and after every other process, the acceleration of these nodes is replaced by the
   * one that moves each to its position in the body at t_{n+1}, which follows from the resultant of
   * the forces and their moment. Nodes that are shared with elements of other parts belong to the
   * body, and rigid parts that share nodes are one. Where another process has changed their masses
   * and velocities, as a remap does, the body gets these masses, the momentum and the angular
   * momentum; the loss of kinetic energy, and of a prescribed momentum, is accounted for with that
   * of the remap.
   */
  template <int dim>
  class RigidBodies : public Process<dim>
  {
  public:
    /** Collects the rigid parts, sets the initial velocity of their nodes. Throws InputError.
     * Collective. */
    RigidBodies(const Parameters &parameters, Model<dim> &model)
        : impulses(model.impulses),
          is_first_rank(dealii::Utilities::MPI::this_mpi_process(model.communicator) == 0)
    {
      this->roles.rest = ProcessRole::is_refused;
      this->roles.divided_cells = ProcessRole::is_refused;
      const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
      const bool all_are_rigid =
          std::all_of(model.parts.begin(), model.parts.end(),
                      [](const Part<dim> &part) { return rigid_cells(part) != nullptr; });
      if (all_are_rigid && !(fixed_step(parameters) > 0.))
        parameters.fail("Time step/Fixed",
                        "all parts of the scene are rigid and limit no step; give "
                        "the step here.");
      start_interval = all_are_rigid ? 1e-3 * fixed_step(parameters) : short_interval(model);
      joined = find_rigid_bodies(sections, model);
      for (JoinedParts &body : joined)
      {
        const unsigned int leader = body.parts.front();
        RigidBodySettings<dim> motion(sections[leader].subsection("rigid"));
        check_rigid_body(sections[leader], motion, model, body);
        bodies.emplace_back(model.parts[leader].name, std::move(motion), inertia_of(body, model));
        start(sections[leader].subsection("rigid"), bodies.size() - 1, model);
      }
      masses_have_changed(model);
      model.state.unsmoothed_velocity.distribute();
      list(model);
      observe();
    }

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      if (!std::exchange(masses_can_be_old, false) || !masses_have_changed(model))
        return {};
      NodalVector &v_hat = model.state.unsmoothed_velocity;
      const ModelContent before = ModelContent::of(model);
      double rotation_before = 0, rotation_after = 0;
      for (const RigidBody<dim> &body : bodies)
        rotation_before += body.energy_beyond_nodes_before(clock.previous_step);
      renew_inertia(model);
      for (std::size_t b = 0; b < bodies.size(); ++b)
      {
        const Wrench momentum = momentum_of_nodes(b, model);
        const auto way_back = bodies[b].set_momentum(clock, momentum.force, momentum.moment);
        for (const unsigned int node : joined[b].nodes)
        {
          const dealii::Tensor<1, 3> way =
              way_back.of(vector_of<3>(model.state.initial_position.node(node)));
          for (unsigned int d = 0; d < dim; ++d)
            v_hat.node(node)[d] = -way[d] / clock.previous_step;
        }
        rotation_after += bodies[b].energy_beyond_nodes_before(clock.previous_step);
      }
      v_hat.distribute();
      const ModelContent after = ModelContent::of(model);
      lost += before.energy + rotation_before - after.energy - rotation_after;
      for (unsigned int d = 0; is_first_rank && d < 3; ++d)
      {
        lost_momentum[d] += before.momentum[d] - after.momentum[d];
        lost_angular_momentum[d] += before.angular_momentum[d] - after.angular_momentum[d];
      }
      return {};
    }

    void model_changed(const Model<dim> &) override
    {
      masses_can_be_old = true;
    }
    void constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                NodalState &state) override
    {
      std::vector<double> sums;
      for (std::size_t b = 0; b < bodies.size(); ++b)
      {
        LoadSum sum;
        for (const unsigned int node : joined[b].nodes)
        {
          const dealii::Tensor<1, 3> r =
              vector_of<3>(state.position.node(node)) - bodies[b].centre();
          sum.add(&r[0], state.force.node(node));
        }
        sums.insert(sums.end(), sum.force.begin(), sum.force.end());
        sums.insert(sums.end(), sum.moment.begin(), sum.moment.end());
      }
      sums = ordered_sum(sums, model.communicator);
      for (std::size_t b = 0; b < bodies.size(); ++b)
      {
        bodies[b].find_motion(clock, vector_of<3>(&sums[6 * b]), vector_of<3>(&sums[6 * b + 3]));
        move_nodes(b, clock, state);
      }
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      for (RigidBody<dim> &body : bodies)
        body.complete_step(clock, is_first_rank ? &impulses : nullptr);
    }

    void after_motion(const Model<dim> &, const Clock &, NodalState &) override
    {
      for (RigidBody<dim> &body : bodies)
        body.advance();
    }

    const std::vector<RigidBody<dim>> &all() const
    {
      return bodies;
    }

    static void declare_parameters(Parameters &parameters)
    {
      for (const std::string &name : section_names(parameters, "Parts"))
        declare<RigidBodySettings<dim>>(
            Entries(parameters.handler()).subsection("Part: " + name).subsection("rigid"));
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
      for (std::size_t p = 0; p < parts.size(); ++p)
        if (rigid_cells(parts[p]) != nullptr)
          RigidBodySettings<dim>(sections[p].subsection("rigid"));
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      if (std::none_of(model.parts.begin(), model.parts.end(),
                       [](const Part<dim> &part) { return rigid_cells(part) != nullptr; }))
        return nullptr;
      return std::make_unique<RigidBodies>(parameters, model);
    }

  private:
    void list(Model<dim> &model)
    {
      const auto renew = [this, &model]
      {
        if (masses_have_changed(model))
          renew_inertia(model);
      };
      this->records.on_reading(renew);
      this->records.on_continuation(renew);
      for (RigidBody<dim> &body : bodies)
        body.list(this->records.group("rigid part " + body.name()));
      this->records.on_continuation(
          [this, &model]
          {
            for (std::size_t b = 0; b < bodies.size(); ++b)
            {
              bodies[b].continue_motion(start_interval);
              set_velocity(b, model.state);
            }
            model.state.unsmoothed_velocity.distribute();
          });
      Records &all_records = this->records.group("rigid parts");
      all_records.value("lost energy", lost);
      all_records.sums("lost momentum", interleaved(lost_momentum, lost_angular_momentum));
    }

    void observe()
    {
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          {
            double kinetic = 0, work = 0;
            for (const RigidBody<dim> &body : bodies)
            {
              kinetic += body.kinetic_energy_beyond_nodes();
              work += body.external_work();
            }
            accounts.add_replicated("kinetic energy", EnergyKind::stored, kinetic);
            accounts.add_replicated("external work", EnergyKind::external, work);
            if (lost != 0.) // beside that of the process which has moved mass
              accounts.add_replicated("remap loss", EnergyKind::dissipated, lost);
            accounts.add_removed_momentum(lost_momentum, lost_angular_momentum);
          });
      this->observed.results.connect([this](const TimeTable &, Json &summary)
                                     { summarize(summary); });
      this->observed.audit.connect([this](std::ostream &text) { describe(text); });
      this->observed.history("rigid body history",
                             [this](BalanceHistory<dim> &row)
                             {
                               for (const RigidBody<dim> &body : bodies)
                                 add_rigid_body_columns(body.balance(), row);
                             });
    }

    void summarize(Json &summary) const
    {
      for (const RigidBody<dim> &body : bodies)
      {
        const RigidInertia &inertia = body.inertia();
        const dealii::Tensor<2, 3> tensor = inertia_of(inertia.second);
        Json entry = Json::object();
        entry["mass"] = inertia.mass;
        entry["centre"] = std::vector<double>(&inertia.centre[0], &inertia.centre[0] + dim);
        if (dim == 2)
          entry["inertia"] = std::vector<double>{tensor[2][2]};
        else
          entry["inertia"] = std::vector<double>{tensor[0][0], tensor[1][1], tensor[2][2],
                                                 tensor[1][2], tensor[0][2], tensor[0][1]};
        summary["rigid_parts"][body.name()] = entry;
      }
    }

    void describe(std::ostream &text) const
    {
      for (const RigidBody<dim> &body : bodies)
      {
        const RigidBodySettings<dim> &motion = body.motion();
        std::string free;
        for (unsigned int d = 0; d < dim; ++d)
          if (motion.is_free(d))
            free += std::string(free.empty() ? "" : ", ") + "xyz"[d];
        const dealii::Tensor<2, 3> tensor = inertia_of(body.inertia().second);
        text << "  rigid part \"" << body.name() << "\": mass " << body.inertia().mass
             << ", centre " << position_text(vector_of<dim>(&body.inertia().centre[0]))
             << ", moments of inertia ";
        if (dim == 2)
          text << tensor[2][2];
        else
          text << position_text(dealii::Tensor<1, 3>({tensor[0][0], tensor[1][1], tensor[2][2]}));
        text << (free.empty() ? ", moves as prescribed" : ", forces move it along " + free)
             << (motion.rotation == RigidRotation::by_angle ? ""
                 : motion.rotation == RigidRotation::free   ? ", moments turn it"
                                                            : ", moments turn it about its axis")
             << "\n";
      }
    }

    /** Σ m v of the nodes of a body, and Σ r × m v about its centre of mass. Collective. */
    Wrench momentum_of_nodes(const std::size_t index, const Model<dim> &model) const
    {
      LoadSum sum;
      for (const unsigned int node : joined[index].nodes)
      {
        const dealii::Tensor<1, 3> momentum =
            *model.bridge->mass().node(node) *
            vector_of<3>(model.state.unsmoothed_velocity.node(node));
        const dealii::Tensor<1, 3> r =
            vector_of<3>(model.state.position.node(node)) - bodies[index].centre();
        sum.add(&r[0], &momentum[0]);
      }
      return {vector_of<3>(ordered_sum(sum.force, model.communicator).data()),
              vector_of<3>(ordered_sum(sum.moment, model.communicator).data())};
    }

    /** Whether the masses of nodes have changed since the last call. Collective. */
    bool masses_have_changed(const Model<dim> &model)
    {
      std::vector<double> now;
      for (const JoinedParts &body : joined)
        for (const unsigned int node : body.nodes)
          now.push_back(*model.bridge->mass().node(node));
      const bool has_changed =
          dealii::Utilities::MPI::max(now == masses ? 0 : 1, model.communicator) == 1;
      masses.swap(now);
      return has_changed;
    }

    /** Sets the inertia of all bodies by the present masses of nodes. Collective. */
    void renew_inertia(const Model<dim> &model)
    {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        bodies[b].set_inertia(inertia_of(joined[b], model));
    }

    /** Sets the initial motion of the body by the initial conditions of its nodes. Collective. */
    void start(const Section &section, const std::size_t index, Model<dim> &model)
    {
      RigidBody<dim> &body = bodies[index];
      const RigidBodySettings<dim> &motion = body.motion();
      const Wrench momenta = momentum_of_nodes(index, model);
      const dealii::Tensor<1, 3> &momentum = momenta.force, &angular_momentum = momenta.moment;
      const bool is_given = momentum.norm() > 0. || angular_momentum.norm() > 0.;
      if (is_given && (motion.initial_velocity || motion.initial_spin))
        section.fail(
            motion.initial_velocity ? "Initial velocity" : "Initial spin",
            "the motion at the start is given twice: an initial condition gives velocities "
            "to nodes of the part too. Remove one of them.");
      const dealii::Tensor<2, 3> inertia = inertia_of(body.inertia().nodal_second);
      dealii::Tensor<1, 3> spin = invert(inertia) * angular_momentum;
      if (motion.rotation == RigidRotation::about_axis)
        spin = (motion.axis * angular_momentum) / (motion.axis * (inertia * motion.axis)) *
               motion.axis;
      body.start(momentum / body.inertia().mass, spin, start_interval);
      set_velocity(index, model.state);
    }

    /** Sets the nodes of a body to its initial velocity. */
    void set_velocity(const std::size_t index, NodalState &state) const
    {
      for (const unsigned int node : joined[index].nodes)
      {
        const dealii::Tensor<1, 3> velocity =
            bodies[index].velocity_at_start(vector_of<3>(state.position.node(node)));
        for (unsigned int d = 0; d < dim; ++d)
          state.unsmoothed_velocity.node(node)[d] = velocity[d];
      }
    }

    /** Sets the acceleration of the nodes of a body for the step that it has found. */
    void move_nodes(const std::size_t index, const Clock &clock, NodalState &state) const
    {
      // The round-off of positions is corrected slowly: at once, it would be a noise of
      // velocities.
      constexpr double share_of_correction = 1e-3;
      const auto from_start = bodies[index].placement();
      const auto step_motion = bodies[index].motion_of_step(clock);
      for (const unsigned int node : joined[index].nodes)
      {
        const dealii::Tensor<1, 3> initial = vector_of<3>(state.initial_position.node(node));
        const dealii::Tensor<1, 3> position = initial + from_start.of(initial),
                                   motion = step_motion.of(initial);
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double correction =
              share_of_correction * (position[d] - state.position.node(node)[d]);
          state.acceleration.node(node)[d] = ((motion[d] + correction) / clock.next_step -
                                              state.unsmoothed_velocity.node(node)[d]) /
                                             clock.velocity_step();
        }
      }
    }

    /** The step that the user gives; zero where none. As text, since it is not declared where a
     * model is made alone. */
    static double fixed_step(const Parameters &parameters)
    {
      return std::strtod(parameters.raw("Time step/Fixed", "0").c_str(), nullptr);
    }

    std::vector<RigidBody<dim>> bodies;
    std::vector<JoinedParts> joined; ///< parts and owned nodes of each
    std::vector<double> masses;      ///< of these nodes, one body after the other
    bool masses_can_be_old = false;
    double lost = 0; ///< kinetic energy; the same on all ranks
    // On the first rank.
    std::array<double, 3> lost_momentum{}, lost_angular_momentum{};
    ImpulseAccount &impulses;  ///< of the model
    double start_interval = 0; ///< short beside the first step [T]
    bool is_first_rank;
  };
} // namespace tombolo
