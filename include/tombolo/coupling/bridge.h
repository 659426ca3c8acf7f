// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/smoothing_settings.h>
#include <tombolo/coupling/constrained_particles.h>
#include <tombolo/coupling/load_transfer.h>
#include <tombolo/coupling/mass_split.h>
#include <tombolo/state/nodal_state.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Smoothing and bridging as operators on the one nodal index space (doc/method.md, sections 3 and
   * 4; Appendix 2 of Pan et al. 2019). The mass of a node is split, by component, into a part that
   * is its own and parts that particles smooth:
   *
   * @verbatim
   *   W = diag(own) + Σ_p Φ_pᵀ diag(smoothed_p)      M = diag(W 1)
   *   M̂ = diag(own) + Σ_p diag(smoothed_p)
   *   S = M⁻¹ W                                      Φ = M̂⁻¹ Wᵀ
   * @endverbatim
   *
   * S and Φ are adjoint, (v, S v̂)_M = (Φ v, v̂)_M̂, for every split. Lumped rows have other masses
   * m and m̂, see MassSplit. The own part is the mass of elements (eqs 48-50, 54-56), and all the
   * mass in prescribed components, whose rows of Φ are unit rows. With the trace bridge the element
   * mass of shared nodes is smoothed too, and elements have the velocity field of the particles
   * there. At a node without particles, S = Φ = I.
   *
   * Affine smoothing uses gradients and offsets in the kernel's reference: S is constant between
   * renewals and S X = X, so that positions x = S x̂ have the velocity v = S v̂, of which strains
   * are made: what an oscillation of v̂ does not move it does not strain either, and the work of
   * the nodal forces on v is that on the positions. Linear momentum and, about x̂, angular momentum
   * are conserved, since Sᵀ transfers f · 1 and f × x to v̂; a rigid spin makes no strain.
   *
   * With planes of symmetry, rows belong to particles and reach into their images, and what they
   * scatter to these is reflected back: S and Φ are those of the whole body on symmetric fields,
   * with half the masses at nodes on a plane.
   *
   * Masses, and all results, are of owned nodes; where ghosts are read they must be current.
   */
  class Bridge
  {
  public:
    /** The smoothed field is a vector, or up to node_stride scalars. */
    Bridge(const SmoothingSettings &smoothing, bool trace, Quantity quantity = Quantity::vector);

    /** Sets which particle parts of reinit() are smoothed, before its first call. The mass of
     * others is their nodes' own, as that of elements is: S and Φ stay adjoint, and are the
     * identity at nodes of such parts alone. By default all are. */
    void set_smoothed_parts(const std::vector<bool> &are_smoothed)
    {
      split.set_smoothed_parts(are_smoothed);
    }

    /** Builds the masses. Call it again whenever shape functions, the partition or constrained
     * components change. Collective. */
    void reinit(const std::shared_ptr<const NodePartition> &partition,
                const MassSplit::Masses &masses);

    /** v = S v̂ (eqs 10-12, 48-50), with current ghosts; nothing where v is that since
     * move_with_smoothed_velocity(). */
    void smooth_velocity(NodalState &state);

    /** The kinds of S and Φ. */
    enum class Operators
    {
      identity,      ///< no particles, or none that are smoothed: S = Φ = I
      interpolation, ///< those of Pan et al. 2019
      sharpened,     ///< S (I + γT) and (I + γT) Φ
      affine
    };
    Operators operators() const;

    /** v̂ += Δt_n Φ a and x += Δt Φ (v + Δt_n a) at owned nodes, with Φ of the paper (or I), in one
     * pass over its rows: eqs (22)-(25), (52)-(56). Ghosts of @p velocity and @p acceleration must
     * be current. */
    void add_interpolated_motion(const NodalVector &velocity, const NodalVector &acceleration,
                                 double velocity_step, double position_step, NodalVector &v_hat,
                                 NodalVector &position);

    /** M̂ dv̂/dt at owned nodes for affine smoothing, the adjoint of S times M a, with prescribed
     * components kept; the reaction over @p time_step is in extract_constraint_reaction(). Valid
     * until the next operation. Collective. */
    const NodalVector &momentum_rate(const NodalState &state, double time_step);

    /** The same as a rate of v̂, Φ_γ a, for every smoothing. Collective. */
    void velocity_rate(const NodalState &state, double time_step, NodalVector &rate);

    /** v = S v̂ with current ghosts, x += Δt v and x̂ += Δt v̂ at owned nodes, for affine smoothing.
     * Ghosts of v̂ must be current. Collective. */
    void move_with_smoothed_velocity(NodalState &state, double time_step);

    /** To be called when nodes have moved: gradients in present positions depend on them. */
    void positions_have_changed();

    /** v̂ -= @p change at owned nodes, but for prescribed components of particles, where @p change
     * becomes zero; updates the ghosts of v̂. Returns this rank's share of the work of what keeps
     * these, which goes to extract_constraint_reaction() as well. Collective. */
    double remove_from_velocity(NodalVector &change, NodalState &state);

    /** The reaction of prescribed components to momentum_rate(), velocity_rate() and
     * remove_from_velocity() since the last call. */
    ConstraintReaction extract_constraint_reaction()
    {
      return constrained_particles.extract_reaction();
    }

    /** Updates the nodal mass after shape functions changed their values or lost neighbours, at the
     * same particles and partition. Throws RunError where it cannot be made positive.
     * Collective. */
    void update_nodal_mass();

    /** Whether rows lost negative values since the last call. Other users of the rows must then use
     * the new ones. */
    bool extract_change_of_rows()
    {
      return split.extract_change_of_rows();
    }

    /** The nodal forces of loads. Its nodes are to be set again after every reinit(). */
    LoadTransfer &load_transfer()
    {
      return loads;
    }

    /** The operator that keeps prescribed components of particles. */
    ConstrainedParticles &get_constrained_particles()
    {
      return constrained_particles;
    }

    /** The velocity of elements: v, except for the trace bridge at shared nodes. */
    const NodalVector &element_velocity(const NodalVector &velocity)
    {
      return trace ? trace_transfer.field_of_particles(velocity) : velocity;
    }

    /** Adds the forces of elements (ghosts collected here) and of particles to the nodal force. */
    void collect_element_force(NodalVector &element_force, NodalVector &force)
    {
      Assert(trace, dealii::ExcInternalError());
      trace_transfer.add_element_force(element_force, force);
    }

    /** The operators, for the step estimator, heat and tests. Arguments must not alias.
     * Results have current ghosts. */
    void apply_smoothing(const NodalVector &unsmoothed, NodalVector &smoothed); ///< S, as chosen
    void apply_adjoint(const NodalVector &field, NodalVector &result);          ///< its adjoint
    void apply_paper_smoothing(const NodalVector &unsmoothed, NodalVector &smoothed); ///< M⁻¹ W
    void apply_interpolation(const NodalVector &field, NodalVector &result); ///< Φ = M̂⁻¹ Wᵀ
    void apply_short_wave_part(const NodalVector &field, NodalVector &result); ///< T = I - ΦS

    /** m of eqs (11), (21), (49), by component. One at nodes whose m̂ is zero: no operator acts on
     * them. */
    const NodalVector &nodal_mass() const
    {
      return split.nodal_mass;
    }
    /** m̂, scalar. */
    const NodalVector &mass() const
    {
      return split.unsmoothed_mass();
    }
    /** The mass of the cells and particles of each node, scalar: m̂ but for lumped rows. */
    const NodalVector &lumped_mass() const
    {
      return split.total_mass;
    }

    /** The masses that S and Φ are made of. */
    const MassSplit &mass_split() const
    {
      return split;
    }

    bool has_particles() const
    {
      return !split.parts.empty();
    }
    bool is_trace() const
    {
      return trace;
    }
    const SmoothingSettings &smoothing() const
    {
      return settings;
    }

    /** Kinetic energy ½ v̂·M̂ v̂ of a nodal field, and the share of it that the paper's S removes: the
     * lattice-mode monitor. Collective. */
    double kinetic_energy(const NodalVector &unsmoothed) const
    {
      return MassSplit::kinetic_energy(split.unsmoothed_mass(), unsmoothed);
    }

    double short_wave_share(const NodalVector &unsmoothed);

  private:
    /** momentum := M times the adjoint of the affine smoothing of @p nodal_values, at owned
     * nodes. */
    void collect_affine_adjoint(const NodalVector &nodal_values);
    void momentum_to_velocity(NodalVector &velocity);

    SmoothingSettings settings;
    bool trace;
    Quantity quantity;
    bool momentum_is_current = false; // it is that of the unsmoothed velocity
    bool velocity_is_current = false; // it is S of the unsmoothed velocity

    MassSplit split;
    LoadTransfer loads;
    TraceTransfer trace_transfer;
    ConstrainedParticles constrained_particles;
    NodalVector momentum; // scatter target
    NodalVector scratch, second_scratch;
  };
} // namespace tombolo
