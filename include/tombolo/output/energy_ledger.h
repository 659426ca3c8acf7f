// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/contact/penalty_contact.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/output/erosion_loss.h>
#include <tombolo/state/nodal_state.h>

#include <array>
#include <cstdint>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** Energies and momenta, and work and impulse of the external forces, at one time; sums over all
   * ranks. */
  struct EnergyBalance
  {
    double kinetic = 0;          ///< ½ v̂_{n-1/2} · M̂ v̂_{n+1/2} [M L^2/T^2]
    double smoothed_kinetic = 0; ///< ½ v · M v at t_{n-1/2}
    double elastic = 0;          ///< from the stored stress
    double plastic = 0;
    double hourglass = 0;
    double viscous = 0;
    double filtered = 0;             ///< taken by the lattice filter
    double failure = 0;              ///< lost with bonds that broke
    double self_contact = 0;         ///< stored in springs between fragments
    double self_contact_damping = 0; ///< taken by contact between fragments
    double contact = 0;              ///< stored in the springs of contact
    double friction = 0;             ///< heat of sliding
    double damping = 0;              ///< taken by the damping of contact
    double tool_kinetic = 0;         ///< of surfaces with a mass, as `kinetic`
    /** Of loads, of prescribed motion, and of surfaces: what moves them puts in. */
    double external_work = 0;
    double thermal_work = 0; ///< of changes of the temperature on the elastic energy
    double mass_scaling = 0; ///< that mass had which was added in motion
    double conversion = 0;   ///< lost where cells became particles
    ErosionLoss erosion;     ///< of cells that were removed
    double total = 0;        ///< kinetic, stored, dissipated, eroded and lost by conversion
    double initial_total = 0;
    /** (total - external, thermal work, mass scaling - initial total) / largest total so far */
    double error = 0;
    double short_wave_share = 0;      ///< of the kinetic energy of v̂ that S removes
    std::array<double, 3> momentum{}; ///< Σ m̂ v̂_{n-1/2} [M L/T]
    std::array<double, 3> impulse{};  ///< of loads, reactions and added mass since the start
    std::array<double, 3> angular_momentum{}; ///< Σ x_n × m̂ v̂_{n-1/2} [M L^2/T]
    std::array<double, 3> angular_impulse{};
    std::array<double, 3> tool_momentum{}; ///< of surfaces with a mass, at t_{n-1/2}
    double momentum_scale = 0;             ///< Σ m̂ |v̂|, or the largest so far
    double angular_momentum_scale = 0;     ///< Σ |x - x̄| m̂ |v̂|, or the largest so far
    /** |momentum + what eroded - initial - impulse| / scale. Only of components that the body keeps
     * by itself: what planes of symmetry give to it is not booked as an impulse. */
    double momentum_drift = 0;
    double angular_momentum_drift = 0;
  };

  /**
   * Books what happens to energy and momentum (doc/method.md, section 14). Internal energy
   * comes from the stored state of the material points, never from Δt F · v, so that the balance is
   * a test and not an identity. Works and impulses accumulate on each rank and are summed when
   * asked for.
   */
  class EnergyLedger
  {
  public:
    /** Books the impulse of the nodal forces of contact at t_n; call it before accumulate(). Their
     * energy comes from the contacts themselves. */
    void add_contact_force(const NodalState &state, const Clock &clock,
                           const NodalVector &contact_force);

    /** Books the step from t_{n-1} to t_n, after the acceleration at t_n is complete: the work of
     * the loads and reactions at both ends on v_{n-1/2}, and the impulse of Δt_n. @p load_force may
     * be null. @p constrained_nodes are ascending, @p constrained as in Bridge::reinit. */
    void accumulate(const NodalState &state, const Bridge &bridge, const Clock &clock,
                    const NodalVector *load_force,
                    const std::vector<unsigned int> &constrained_nodes,
                    const std::vector<std::uint8_t> &constrained);

    /** Books what the bridge did to keep prescribed components of particles (this rank's). */
    void add_constraint_reaction(const ConstraintReaction &reaction);

    /** Books the energy and the momentum of the mass that was added to nodes in motion, whose
     * velocity stays: the difference of the m̂ of the state and @p previous_mass (scalar). */
    void add_mass_scaling(const NodalState &state, const NodalVector &previous_mass);

    /** Books what left with removed cells (this rank's share). */
    void add_erosion(const ErosionLoss &loss);

    /** Of cells that became particles, by the means of their state: this rank's share. */
    void add_conversion(double lost_energy);

    /** Books energy that was taken on purpose (a sum over all ranks). */
    void add_filtered(double energy);

    /** The balance at t_n, before the advance. @p parts are the energies of this rank's points,
     * @p contact the sum of all contacts over all ranks. Collective. */
    EnergyBalance balance(NodalState &state, Bridge &bridge, const Clock &clock,
                          const PartEnergies &parts, const ContactBalance &contact);

    /** Books what accumulate() would of the forces at t_{n-1}, at the beginning of the step to t_n,
     * for nodes that will not have their velocity v_{n-1/2} or their place in the lists any more
     * then; it must be in @p state, smoothed. The lists are those of the last accumulate(). */
    void book_first_half(const NodalState &state, const Bridge &bridge,
                         const std::vector<unsigned int> &constrained_nodes,
                         const std::vector<std::uint8_t> &constrained);

    /** Forgets what it remembers of nodes touched by loads, when their list changed. */
    void forget_load_history();

    /** Writes to a checkpoint or reads from it, between the steps; the nodes are those of
     * accumulate(), and null where the scene has no such conditions. Collective. */
    void serialize(StateArchive &archive, const std::vector<unsigned int> *loaded_nodes,
                   const std::vector<unsigned int> *constrained_nodes);

  private:
    // This rank's shares.
    double external_work = 0;
    double mass_scaling = 0;
    std::array<double, 3> impulse{}, angular_impulse{};
    std::array<double, 3> pending_impulse{}, pending_angular_impulse{}; // of the step in progress
    std::array<double, 3> contact_impulse{}, contact_angular_impulse{}; // of the same step
    std::vector<std::array<double, 3>> previous_load_impulse; // Δt_{n-1} f_{n-1} at touched nodes
    std::vector<std::array<double, 3>> previous_inertia;      // Δt_{n-1} m a at constrained nodes
    std::vector<std::array<double, 3>> previous_force;        // Δt_{n-1} F at constrained nodes
    bool first_half_is_booked = false; // of the step in progress; never between two steps

    ErosionLoss eroded;
    double lost_by_conversion = 0;

    // Of all ranks.
    double filtered = 0;
    bool has_start = false;
    double initial_total = 0;
    double largest_total = 0;
    double largest_momentum = 0;
    double largest_angular_momentum = 0;
    std::array<double, 3> initial_momentum{};
    std::array<double, 3> initial_angular_momentum{};
  };
} // namespace tombolo
