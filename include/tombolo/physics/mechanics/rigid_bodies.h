// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/rigid_body.h>

#include <array>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  /** The owned nodes of the cells of a part, ascending local numbers. */
  template <int dim>
  std::vector<unsigned int> owned_nodes_of_part(const Model<dim> &model, unsigned int part);

  /** A rigid body: the parts of cells that common nodes join, the first of which is the one whose
   * section gives the motion, and their owned nodes, ascending local numbers. */
  struct JoinedParts
  {
    std::vector<unsigned int> parts, nodes;
  };

  /** The rigid bodies of a model, whose parts have the sections @p sections. Throws the InputError
   * of a body whose motion two parts give. Collective. */
  template <int dim>
  std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &sections,
                                             const Model<dim> &model);

  /** The inertia of a body: that of its cells, and the masses that other parts have at shared
   * nodes. Collective. */
  template <int dim>
  RigidInertia inertia_of(const JoinedParts &body, const Model<dim> &model);

  /** Refuses scenes in which the nodes of a body, whose section is @p section, cannot move as a
   * rigid body: nodes shared with particles or cells that become such, nodes that depend on nodes
   * of other parts, conditions and contacts that move its nodes one by one, motion out of a plane
   * of symmetry. Leaves out of @p body the nodes that depend on others. Throws InputError.
   * Collective.
   */
  template <int dim>
  void check_rigid_body(const Section &section, const RigidBodySettings<dim> &motion,
                        const Model<dim> &model, JoinedParts &body);

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

    /** Gives all bodies the inertia for the masses that nodes have now. Collective. */
    void renew_inertia(const Model<dim> &model)
    {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        bodies[b].set_inertia(inertia_of(joined[b], model));
    }

    /** Moves the body by what initial conditions gave to its nodes. Collective. */
    void start(const Section &section, std::size_t index, Model<dim> &model);

    /** Gives the nodes of a body its velocity at the start. */
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
