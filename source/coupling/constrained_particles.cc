// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/constrained_particles.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    bool is_prescribed(const ConstrainedParticle &particle, const unsigned int c)
    {
      return ((particle.components >> c) & 1u) != 0;
    }
  } // namespace

  ConstrainedParticles::ConstrainedParticles(const MassSplit &split) : split(split) {}

  void ConstrainedParticles::reinit(const std::vector<std::uint8_t> &constrained)
  {
    const auto &partition = split.total_mass.partition();
    const std::vector<ConstrainedParticle> before = std::exchange(of_rank, {});
    auto known = before.begin();
    if (!constrained.empty())
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (constrained[i] != 0 && split.n_particle_parts[i] > 0)
        {
          ConstrainedParticle &particle = of_rank.emplace_back();
          particle.node = i;
          particle.components = constrained[i];
          known = std::find_if(known, before.end(),
                               [&](const ConstrainedParticle &other) { return other.node >= i; });
          if (known != before.end() && known->node == i)
            particle.reactions = known->reactions;
        }
    are_anywhere = Utilities::MPI::max(of_rank.empty() ? 0 : 1, partition->communicator()) == 1;
  }

  void ConstrainedParticles::keep_velocity(const NodalVector &unsmoothed, NodalVector &smoothed)
  {
    for (ConstrainedParticle &particle : of_rank)
    {
      double *const velocity = smoothed.node(particle.node);
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
        {
          particle.smoothed_velocity[c] = velocity[c];
          velocity[c] = unsmoothed.node(particle.node)[c];
        }
    }
    if (are_anywhere)
      smoothed.update_ghosts();
  }

  void ConstrainedParticles::restore(NodalVector &rate, const NodalVector &prescribed,
                                     const NodalVector &v_hat, const NodalVector &position,
                                     const double time_step)
  {
    for (ConstrainedParticle &particle : of_rank)
    {
      const double *const x = position.node(particle.node);
      std::array<double, 3> impulse{};
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
        {
          double &changed = rate.node(particle.node)[c];
          const double wanted = prescribed.node(particle.node)[c];
          impulse[c] =
              *split.unsmoothed_mass().node(particle.node) * time_step * (wanted - changed);
          const double work =
              impulse[c] * (v_hat.node(particle.node)[c] + 0.5 * time_step * wanted);
          reaction.work += work;
          changed = wanted;
          particle.reactions[c].add(c, impulse[c], x, work);
        }
      for (unsigned int c = 0; c < 3; ++c)
        reaction.impulse[c] += impulse[c];
      add_moment(x, impulse.data(), reaction.angular_impulse);
    }
  }

  void ConstrainedParticles::remove_from(NodalVector &change)
  {
    for (ConstrainedParticle &particle : of_rank)
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
        {
          const double impulse =
              *split.unsmoothed_mass().node(particle.node) * change.node(particle.node)[c];
          reaction.impulse[c] += impulse;
          particle.reactions[c].impulse[c] += impulse;
          change.node(particle.node)[c] = 0.;
        }
  }

  ConstraintReaction ConstrainedParticles::take_reaction()
  {
    for (ConstrainedParticle &particle : of_rank)
      particle.reactions = {};
    return std::exchange(reaction, {});
  }

  const std::vector<ConstrainedParticle> &ConstrainedParticles::particles() const
  {
    return of_rank;
  }
} // namespace tombolo
