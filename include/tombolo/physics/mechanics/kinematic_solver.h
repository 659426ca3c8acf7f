// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/coupling/position_response.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  template <int dim>
  class Model;

  template <int dim>
  class KinematicContact;

  /** Contact by the forces that move nodes onto a surface, `kinematic`, among the @p contacts of a
   * KinematicSolver. Throws InputError. Collective. */
  template <int dim>
  std::unique_ptr<SurfaceContact<dim>>
  make_kinematic_contact(ContactScene<dim> &scene, std::vector<KinematicContact<dim> *> &contacts);

  /**
   * Finds the forces of all kinematic contacts of a scene in a step, together: those of one contact
   * move the nodes of others. Sweeps end when they change positions by less than 1e-3 of the
   * deepest predicted penetration, or after 200; the remaining error is part of the next
   * prediction. Sums over ranks are those of nodal forces, so that results on other numbers of
   * ranks agree to round-off.
   */
  template <int dim>
  class KinematicSolver
  {
  public:
    /** The contacts and the bridge of @p model must outlive this. */
    KinematicSolver(std::vector<KinematicContact<dim> *> contacts, const Model<dim> &model);

    /** The forces at t_n, once the acceleration by all others is complete, with its ghosts, and the
     * size of the coming step set. Adds them to @p loads at positions, and their nodes to @p
     * loaded_nodes. Collective. */
    void solve(const Model<dim> &model, const Clock &clock, const NodalHeat &nodal_heat,
               NodalVector &loads, std::vector<unsigned int> &loaded_nodes);

  private:
    /** Finds the nodes that can come behind a surface in the step, judged without B. Returns
     * whether there is one on any rank. Collective. */
    bool find_near_nodes(const Model<dim> &model, const Clock &clock);
    /** Sets the nodes that respond: those behind surfaces, and those near them. Collective. */
    void set_responding_nodes(const Model<dim> &model);
    /** Begins the step of all contacts. Returns the deepest penetration. Collective. */
    double find_constraints(const Model<dim> &model, const Clock &clock,
                            const NodalHeat &nodal_heat);
    void sweep(const Model<dim> &model, const Clock &clock, double tolerance);

    std::vector<KinematicContact<dim> *> contacts;
    PositionResponse position_response;
    NodalVector predicted, trial_loads, response, count;
    std::vector<unsigned int> candidates, near, nodes, responding;
    // Of the responding nodes.
    std::shared_ptr<const NodePartition> rows_of;
    unsigned long stencils_of_rows = 0, cells_of_rows = 0; // revisions
    std::vector<std::uint8_t> constrained_of_rows;
  };
} // namespace tombolo
