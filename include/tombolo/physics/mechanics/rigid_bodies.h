// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/rigid_body.h>
#include <tombolo/physics/mechanics/rigid_body_setup.h>

#include <array>
#include <vector>

namespace tombolo
{
  class NodalState;

  /**
   * The parts with `Formulation = rigid`. All forces act on their nodes as on any others; when they
   * are complete, and after every other process, the acceleration of these nodes is replaced by the
   * one that brings each to its place in the body at t_{n+1}, which follows from the resultant of
   * the forces and their moment. Nodes that are shared with elements of other parts belong to the
   * body, and rigid parts that share nodes are one. Where another process has changed their masses
   * and velocities, as a remap does, the body takes these masses, the momentum and the angular
   * momentum; what is lost of the kinetic energy, and of a momentum that is prescribed, is booked
   * with that of the remap.
   */
  template <int dim>
  class RigidBodies : public Process<dim>
  {
  public:
    /** Collects the rigid parts, gives their nodes the velocity at the start. Throws InputError.
     * Collective. */
    RigidBodies(const Parameters &parameters, Model<dim> &model);

    ModelChange change_model(Model<dim> &model, const Clock &clock) override;
    void model_changed(const Model<dim> &) override
    {
      masses_can_be_old = true;
    }
    void constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                NodalState &state) override;

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

  private:
    void list(Model<dim> &model);
    void observe();
    void summarize(Json &summary) const;
    void describe(std::ostream &text) const;

    /** Σ m v of the nodes of a body, and Σ r × m v about its centre of mass. Collective. */
    Wrench momentum_of_nodes(std::size_t index, const Model<dim> &model) const;

    /** Whether nodes have other masses than when this was asked last. Collective. */
    bool masses_have_changed(const Model<dim> &model);

    /** Gives all bodies the inertia for the masses that nodes have now. Collective. */
    void renew_inertia(const Model<dim> &model)
    {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        bodies[b].set_inertia(inertia_of(joined[b], model));
    }

    /** Moves the body by what initial conditions gave to its nodes. Collective. */
    void start(const Section &section, std::size_t index, Model<dim> &model);

    /** Gives the nodes of a body its velocity at the start. */
    void set_velocity(std::size_t index, NodalState &state) const;

    /** Sets the acceleration of the nodes of a body for the step that it has found. */
    void move_nodes(std::size_t index, const Clock &clock, NodalState &state) const;

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
