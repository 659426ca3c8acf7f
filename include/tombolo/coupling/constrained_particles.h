// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/coupling/mass_split.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <cstdint>
#include <vector>

namespace tombolo
{
  /** Work and impulse of the reaction that smoothing and filter meet at prescribed components of
   * particles, beyond that of m a - F; sums over this rank. */
  struct ConstraintReaction
  {
    double work = 0;                         ///< [M L^2/T^2]
    std::array<double, 3> impulse{};         ///< [M L/T]
    std::array<double, 3> angular_impulse{}; ///< [M L^2/T]

    /** Adds an impulse along component @p c at @p position (three components) and its work. */
    void add(const unsigned int c, const double of_component, const double *position,
             const double of_work)
    {
      std::array<double, 3> added{};
      added[c] = of_component;
      work += of_work;
      impulse[c] += of_component;
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
    /** Of each prescribed component since the last ConstrainedParticles::take_reaction(). */
    std::array<ConstraintReaction, 3> reactions{};
  };

  /**
   * Keeps prescribed components of smoothed particles through the operators of the Bridge, and
   * books what that takes. The rows of Φ of these components are unit rows, but S mixes in what is
   * near, and the adjoints of the affine and of the sharpened S change them through gradients and
   * T. Holds owned nodes.
   */
  class ConstrainedParticles
  {
  public:
    /** @p split must outlive this. */
    explicit ConstrainedParticles(const MassSplit &split);

    /** Finds them; @p constrained as in Bridge::reinit(). What is known of the same nodes, owned
     * ones, stays. Collective. */
    void reinit(const std::vector<std::uint8_t> &constrained);

    /** Puts prescribed components of @p smoothed to those of @p unsmoothed, and brings its ghosts
     * up to date. Collective. */
    void keep_velocity(const NodalVector &unsmoothed, NodalVector &smoothed);

    /** Sets @p rate of v̂ to @p prescribed at prescribed components, and adds what the difference
     * does over @p time_step to the reaction; @p position is that which v̂ moves. */
    void restore(NodalVector &rate, const NodalVector &prescribed, const NodalVector &v_hat,
                 const NodalVector &position, double time_step);

    /** Puts prescribed components of @p change, which is taken from v̂, to zero. */
    void remove_from(NodalVector &change);

    /** What restore() and remove_from() did since the last call, all particles together; theirs are
     * zero from now on. */
    ConstraintReaction take_reaction();

    const std::vector<ConstrainedParticle> &particles() const;

  private:
    const MassSplit &split;
    std::vector<ConstrainedParticle> of_rank;
    bool are_anywhere = false; // on any rank
    ConstraintReaction reaction;
  };
} // namespace tombolo
