// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>

#include <cstdint>
#include <vector>

namespace tombolo
{
  /**
   * Kinematic contact, the predictor and corrector known from explicit codes: a candidate node that
   * would be behind the surface at t_{n+1} without a force of contact gets at t_n the force that
   * puts it onto the surface, and along the surface the one that makes it move with it, up to
   * Coulomb's limit,
   *
   * @verbatim
   *   0 <= N  ⟂  g_{n+1} >= 0,   |T| <= µ N,   f = N n + T
   * @endverbatim
   *
   * with the gap g and the normal n linear about the predicted position. Forces at positions move
   * those of their neighbours too: the forces f are found by sweeps of projected Jacobi steps with
   * the momentum of Nesterov, of all contacts at once,
   *
   * @verbatim
   *   N <- max(0, N - m g / (Δt Δt_n)),   T <- T - m s / (Δt Δt_n), back to the limit,
   * @endverbatim
   *
   * with the slip s of the step and the mass m of the position, which no eigenvalue of the response
   * exceeds. There is no spring and nothing stored. What an impact takes is the work of the normal
   * forces, by the mean of those at both ends of each step, and is accounted for as damping.
   */
  template <int dim>
  class KinematicContact : public SurfaceContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    explicit KinematicContact(ContactScene<dim> &scene);

    /** The least gap of candidates at the positions @p guess at the end of the coming step [L], of
     * this rank. */
    double least_gap(const NodalVector &guess, const Clock &clock);

    /** Begins a step: finds the nodes that would be behind the surface at the @p predicted
     * positions at t_{n+1}. @p mass (scalar or by component) is that of positions, @p constrained
     * has a bit per prescribed component of an owned node, or is empty: nodes that cannot move
     * along the normal are left to what prescribes them. Returns the deepest penetration of this
     * rank [L]. */
    double begin_step(const NodalState &state, const NodalVector &predicted,
                      const NodalVector &mass, const std::vector<std::uint8_t> &constrained,
                      const Clock &clock, const NodalHeat &nodal_heat);

    /** Appends the owned nodes with a constraint in this step. */
    void append_nodes_behind(std::vector<unsigned int> &nodes) const;

    /** Adds one to owned nodes of @p count (scalar) for each constraint. */
    void count_constraints(NodalVector &count) const;

    /** Softens the steps of correct() by the @p count of constraints of all contacts at each node,
     * and by the ratio to the mass of the surface. Collective where the surface has a mass. */
    void share_masses(const NodalVector &count);

    /** Adds the forces to be tried to owned nodes of @p loads. */
    void add_trial_forces(NodalVector &loads) const;

    /** One sweep: corrects the forces by the displacement that those to be tried make by Δt Δt_n,
     * and sets the next ones to try, further by @p momentum of the correction. Returns the largest
     * correction of this rank as a displacement [L]. Collective where the surface has a mass. */
    double correct(const NodalVector &response, const Clock &clock, double momentum);

    /** Ends the step: forces at t_n, works and heat of the last step. Adds the forces to owned
     * nodes of @p loads, and appends these nodes to @p loaded_nodes. Collective. */
    void end_step(const NodalState &state, const Clock &clock, const NodalHeat &nodal_heat,
                  NodalVector &loads, std::vector<unsigned int> &loaded_nodes);

  private:
    using typename SurfaceContact<dim>::NodeHistory;

    /** A node that would be behind the surface. */
    struct Constraint
    {
      std::size_t candidate;
      double gap;                    ///< predicted at t_{n+1} [L]
      dealii::Tensor<1, dim> normal; ///< of the surface there
      dealii::Tensor<1, dim> slip;   ///< predicted of the step, along the surface [L]
      double friction;               ///< Coulomb's coefficient
      double shear_limit;            ///< of the force along the surface [M L/T^2]
      double mass;                   ///< of a step of correct() [M]
      double normal_force = 0, trial_normal_force = 0;             ///< N [M L/T^2]
      dealii::Tensor<1, dim> friction_force, trial_friction_force; ///< T [M L/T^2]
      dealii::Tensor<1, dim> response;            ///< displacement by the forces in the step [L]
      dealii::Tensor<1, dim> response_of_surface; ///< likewise
    };

    void add_node_sums(ContactBalance &shares) const override;

    /** Where candidates will be, from a surface with a mass that goes on by @p free_motion. */
    void find_places_from_mass(const NodalVector &predicted,
                               const dealii::Tensor<1, dim> &free_motion);

    /** Appends a constraint of a candidate behind the surface unless its node is held. */
    void add_constraint(std::size_t candidate, const dealii::Tensor<1, dim> &place,
                        const dealii::Tensor<1, dim> &motion, const NodalVector &mass,
                        unsigned int held_components, const Clock &clock,
                        const NodalHeat &nodal_heat);

    /** How deep the nodes are that forces put onto the surface. */
    void measure_depths(const NodalState &state, double time);

    /** How far the trial forces move a surface with a mass, over Δt Δt_n [M]. Collective there. */
    dealii::Tensor<1, dim> response_of_surface() const;

    std::vector<Constraint> constraints;
    NodalVector places_from_mass; ///< of candidates, where the surface has a mass
    std::vector<dealii::Tensor<1, dim>> normal_forces; ///< N n of each candidate at t_n
    double loss_of_tool = 0; ///< of t_0, accounted for in the next step [M L^2/T^2]
    double deepest = 0;      ///< of the nodes in contact at t_n, on this rank [L]
  };
} // namespace tombolo
