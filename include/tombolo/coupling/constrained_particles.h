// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/coupling/mass_split.h>
#include <tombolo/state/nodal_state.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Work and impulse of the reaction at prescribed components of particles to smoothing and to
   * what is removed from v̂, beyond that of m a - F; sums over this rank. */
  struct ConstraintReaction
  {
    double work = 0;                         ///< [M L^2/T^2]
    std::array<double, 3> impulse{};         ///< [M L/T]
    std::array<double, 3> angular_impulse{}; ///< [M L^2/T]

    /** Adds an impulse along component @p c at @p position (three components) and its work. */
    void add(const unsigned int c, const double component_impulse, const double *position,
             const double component_work)
    {
      std::array<double, 3> added{};
      added[c] = component_impulse;
      work += component_work;
      impulse[c] += component_impulse;
      add_moment(position, added.data(), angular_impulse);
    }
  };

  /** A particle with prescribed components, and what S alone would have made of its velocity when
   * it was smoothed last: needed for the work of the reaction. */
  struct ConstrainedParticle
  {
    unsigned int node;       ///< owned
    std::uint8_t components; ///< a bit for each
    std::array<double, 3> smoothed_velocity{};
    /** S x̂ - x at prescribed components, with affine smoothing [L]. */
    std::array<double, 3> offset{};
    /** Of each prescribed component, see ConstrainedParticles::find_moments() [M L^2/T^2]. */
    std::array<std::array<double, 3>, 3> moments{};
    /** Of each prescribed component since the last ConstrainedParticles::extract_reaction(). */
    std::array<ConstraintReaction, 3> reactions{};
  };

  /**
   * Keeps prescribed components of smoothed particles through the operators of the Bridge, and
   * records the reactions. The rows of Φ of these components are unit rows, but S mixes in what is
   * near, and the adjoints of the affine and of the sharpened S change them through gradients and
   * T. Holds owned nodes.
   */
  class ConstrainedParticles
  {
  public:
    /** @p split must outlive this. */
    explicit ConstrainedParticles(const MassSplit &split) : split(split) {}

    /** Finds them; @p constrained as in MassSplit::Masses. Data of nodes that were constrained
     * before stay. Collective. */
    void reinit(const std::vector<std::uint8_t> &constrained);

    /** Sets prescribed components of @p smoothed to those of @p unsmoothed, and updates its ghosts.
     * Collective. */
    void keep_velocity(const NodalVector &unsmoothed, NodalVector &smoothed);

    /** Sets prescribed components of @p vector to those of @p prescribed, and updates its ghosts.
     * Books nothing. Collective. */
    void set_prescribed(const NodalVector &prescribed, NodalVector &vector) const;

    /** Sets @p rate of v̂ to @p prescribed at prescribed components, and adds what the difference
     * does over @p time_step to the reaction; @p position is that which v̂ moves. */
    void restore(NodalVector &rate, const NodalVector &prescribed, const NodalVector &v_hat,
                 const NodalVector &position, double time_step);

    /** Moves x and x̂ with v and v̂ for @p time_step; @p velocity as keep_velocity() left it. */
    void move(double time_step, const NodalVector &velocity);

    /**
     * Finds the moments of the particles. The nodal forces m a have the moment Σ x × m a, and what
     * they do to v̂ has the moment Σ x̂ × Sᵀ m a, which is the same as long as one S serves all
     * components and x is S x̂. Prescribed components are not smoothed and stay where they are put:
     * the rest is the moment of what holds them there, besides that of the reactions,
     *
     * @verbatim
     *   Σ_I (S x̂ - x)_I,d (W 1)_I,d ã_I,e + Σ_J m̂_J (p_e - p_d)_J ((x̂ - x)_J,d ã_J,e
     *                                        - Σ_K φ_K(X_J) (y_J(X_K) - x_K)_d ã_K,e)
     * @endverbatim
     *
     * for d to e, less that for e to d; p is 1 where a component is prescribed, ã = m a / (W 1),
     * and y_J(X) = x̂_J + Σ_K (x̂_K - x̂_J) ⊗ ∇φ_K(X_J) (X - X_J). Updates ghosts of x̂. Ghosts of x
     * and of the acceleration are current. For affine smoothing. Collective.
     */
    void find_moments(NodalState &state);

    /** Sets prescribed components of @p change, which is removed from v̂, to zero, and adds the
     * impulse that keeps them, and its work on v̂, to the reaction. Returns this work, the share of
     * this rank [M L^2/T^2]. */
    double remove_from(NodalVector &change, const NodalState &state);

    /** The reaction of all particles to restore() and remove_from() since the last call; resets it
     * to zero. */
    ConstraintReaction extract_reaction()
    {
      for (ConstrainedParticle &particle : rank_particles)
        particle.reactions = {};
      return std::exchange(reaction, {});
    }

    /** With the velocities that Bridge::smooth_velocity() left. */
    const std::vector<ConstrainedParticle> &particles() const
    {
      return rank_particles;
    }
    /** To be changed only where they are read from a checkpoint. */
    std::vector<ConstrainedParticle> &particles()
    {
      return rank_particles;
    }

  private:
    /** A row of a particle with prescribed and with free components. */
    struct MixedRow
    {
      std::size_t part;
      unsigned int row;
      std::size_t particle; ///< in rank_particles
    };

    void find_mixed_rows();
    /** m a / (W 1) of a local node. */
    std::array<double, 3> acceleration_over_rows(const NodalState &state, unsigned int node) const;
    void add_moments(const NodalState &state, const MixedRow &mixed);

    const MassSplit &split;
    std::vector<ConstrainedParticle> rank_particles;
    std::vector<MixedRow> mixed_rows;
    bool are_anywhere = false, are_mixed_anywhere = false; // on any rank
    ConstraintReaction reaction;
  };
} // namespace tombolo
