// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/continued_state.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/mechanics/rigid_body.h>

#include <vector>

namespace tombolo
{
  class NodalState;

  /**
   * The parts with `Formulation = rigid`. All forces act on their nodes as on any others; when they
   * are complete, and after every other process, the acceleration of these nodes is replaced by the
   * one that brings each to its place in the body at t_{n+1}, which follows from the resultant of
   * the forces and their moment. Nodes that are shared with elements of other parts belong to the
   * body.
   */
  template <int dim>
  class RigidBodies : public Process<dim>, public ContinuedState<dim>
  {
  public:
    /** Collects the rigid parts, gives their nodes the velocity at the start. Throws InputError.
     * Collective. */
    RigidBodies(const Parameters &parameters, Model<dim> &model);

    void constrain_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_acceleration(Model<dim> &model, const Clock &clock) override;
    void after_motion(Model<dim> &model, const Clock &clock) override;
    void account(EnergyAccounts &accounts) const override;
    void summarize(const Model<dim> &model, const TimeTable &table, Json &summary) const override;
    void describe(const Model<dim> &model, std::ostream &text) const override;
    void show(OutputView<dim> &view) const override;
    void serialize(Model<dim> &model, StateArchive &archive) override;
    void continue_state(Model<dim> &model, StateArchive &archive) override;

    const std::vector<RigidBody<dim>> &all() const;

  private:
    /** Moves the body by what initial conditions gave to its nodes. Collective. */
    void start(const Section &section, std::size_t index, Model<dim> &model);

    /** Gives the nodes of a body its velocity at the start. */
    void set_velocity(std::size_t index, NodalState &state) const;

    /** Sets the acceleration of the nodes of a body for the step that it has found. */
    void move_nodes(std::size_t index, const Clock &clock, NodalState &state) const;

    std::vector<RigidBody<dim>> bodies;
    std::vector<std::vector<unsigned int>> nodes; ///< owned, of each body
    double start_interval = 0;                    ///< short beside the first step [T]
    bool is_first_rank;
  };
} // namespace tombolo
