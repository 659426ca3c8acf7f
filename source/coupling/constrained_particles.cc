// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/constrained_particles.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    bool is_prescribed(const ConstrainedParticle &particle, const unsigned int c)
    {
      return ((particle.components >> c) & 1u) != 0;
    }

    /** Adds to @p moment the product of component @p e of a force and component @p d of its arm. */
    void add_product(const unsigned int d, const unsigned int e, const double product,
                     std::array<double, 3> &moment)
    {
      moment[3 - d - e] += (d + 1) % 3 == e ? product : -product;
    }
  } // namespace

  void ConstrainedParticles::reinit(const std::vector<std::uint8_t> &constrained)
  {
    const auto &partition = split.total_mass.partition();
    const std::vector<ConstrainedParticle> before = std::exchange(rank_particles, {});
    auto former = before.begin();
    if (!constrained.empty())
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (constrained[i] != 0 && split.n_particle_parts[i] > 0)
        {
          ConstrainedParticle &particle = rank_particles.emplace_back();
          particle.node = i;
          particle.components = constrained[i];
          former = std::find_if(former, before.end(),
                                [&](const ConstrainedParticle &other) { return other.node >= i; });
          if (former != before.end() && former->node == i)
          {
            particle.reactions = former->reactions;
            particle.offset = former->offset;
          }
        }
    find_mixed_rows();
    std::vector<int> are{rank_particles.empty() ? 0 : 1, mixed_rows.empty() ? 0 : 1};
    Utilities::MPI::max(are, partition->communicator(), are);
    are_anywhere = are[0] == 1;
    are_mixed_anywhere = are[1] == 1;
  }

  void ConstrainedParticles::find_mixed_rows()
  {
    constexpr std::uint8_t all = 7;
    mixed_rows.clear();
    if (rank_particles.empty())
      return;
    for (std::size_t p = 0; p < split.parts.size(); ++p)
      for (unsigned int row = 0;
           split.parts[p].is_smoothed && row < split.parts[p].shape->n_particles(); ++row)
      {
        const unsigned int node = split.parts[p].shape->particle_node[row];
        const auto found = std::lower_bound(rank_particles.begin(), rank_particles.end(), node,
                                            [](const ConstrainedParticle &particle,
                                               const unsigned int i) { return particle.node < i; });
        if (found != rank_particles.end() && found->node == node && found->components != all)
          mixed_rows.push_back({p, row, std::size_t(found - rank_particles.begin())});
      }
  }

  void ConstrainedParticles::move(const double time_step, const NodalVector &velocity)
  {
    for (ConstrainedParticle &particle : rank_particles)
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
          particle.offset[c] +=
              time_step * (particle.smoothed_velocity[c] - velocity.node(particle.node)[c]);
  }

  std::array<double, 3> ConstrainedParticles::acceleration_over_rows(const NodalState &state,
                                                                     const unsigned int node) const
  {
    std::array<double, 3> result;
    for (unsigned int c = 0; c < 3; ++c)
      result[c] = state.acceleration.node(node)[c] * split.nodal_mass.node(node)[c] /
                  split.row_sums().node(node)[c];
    return result;
  }

  void ConstrainedParticles::find_moments(NodalState &state)
  {
    if (are_mixed_anywhere)
      state.unsmoothed_position.update_ghosts();
    for (ConstrainedParticle &particle : rank_particles)
    {
      particle.moments = {};
      const std::array<double, 3> a = acceleration_over_rows(state, particle.node);
      for (unsigned int d = 0; d < 3; ++d)
        for (unsigned int e = 0; is_prescribed(particle, d) && e < 3; ++e)
          if (e != d)
            add_product(d, e, split.row_sums().node(particle.node)[d] * particle.offset[d] * a[e],
                        particle.moments[d]);
    }
    for (const MixedRow &mixed : mixed_rows)
      add_moments(state, mixed);
  }

  void ConstrainedParticles::add_moments(const NodalState &state, const MixedRow &mixed)
  {
    const MassSplit::ParticlePart &part = split.parts[mixed.part];
    ConstrainedParticle &particle = rank_particles[mixed.particle];
    const Stencils::Row row = part.shape->row(mixed.row);
    const NodalVector &x_hat = state.unsmoothed_position, &x = state.position,
                      &reference = part.shape->reference_position;
    const double *const own = x_hat.node(particle.node);
    double slope[3][3] = {}; // ∂y/∂X
    for (unsigned int k = 0; k < row.size; ++k)
      for (unsigned int d = 0; d < 3; ++d)
        for (unsigned int f = 0; f < 3; ++f)
          slope[d][f] += (x_hat.node(row.neighbour[k])[d] - own[d]) *
                         row.gradient[k * Stencils::n_gradient + f];
    double product[3][3]; // of arms and accelerations
    const std::array<double, 3> particle_acceleration =
        acceleration_over_rows(state, particle.node);
    for (unsigned int d = 0; d < 3; ++d)
      for (unsigned int e = 0; e < 3; ++e)
        product[d][e] = (own[d] - x.node(particle.node)[d]) * particle_acceleration[e];
    for (unsigned int k = 0; k < row.size; ++k)
    {
      const unsigned int node = row.neighbour[k];
      const std::array<double, 3> a = acceleration_over_rows(state, node);
      for (unsigned int d = 0; d < 3; ++d)
      {
        double arm = own[d] - x.node(node)[d];
        for (unsigned int f = 0; f < 3; ++f)
          arm += slope[d][f] * (reference.node(node)[f] - reference.node(particle.node)[f]);
        for (unsigned int e = 0; e < 3; ++e)
          product[d][e] -= row.value[k] * arm * a[e];
      }
    }
    // The last slot of a node is no component, and nothing prescribes it.
    const double mass = part.smoothed_mass[std::size_t(mixed.row) * node_stride + 3];
    for (unsigned int d = 0; d < 3; ++d)
      for (unsigned int e = 0; e < 3; ++e)
        if (is_prescribed(particle, d) != is_prescribed(particle, e))
        {
          const bool is_of_force = is_prescribed(particle, e);
          add_product(d, e, (is_of_force ? mass : -mass) * product[d][e],
                      particle.moments[is_of_force ? e : d]);
        }
  }

  void ConstrainedParticles::keep_velocity(const NodalVector &unsmoothed, NodalVector &smoothed)
  {
    for (ConstrainedParticle &particle : rank_particles)
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
          particle.smoothed_velocity[c] = smoothed.node(particle.node)[c];
    set_prescribed(unsmoothed, smoothed);
  }

  void ConstrainedParticles::set_prescribed(const NodalVector &prescribed,
                                            NodalVector &vector) const
  {
    for (const ConstrainedParticle &particle : rank_particles)
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
          vector.node(particle.node)[c] = prescribed.node(particle.node)[c];
    if (are_anywhere)
      vector.update_ghosts();
  }

  void ConstrainedParticles::restore(NodalVector &rate, const NodalVector &prescribed,
                                     const NodalVector &v_hat, const NodalVector &position,
                                     const double time_step)
  {
    for (ConstrainedParticle &particle : rank_particles)
    {
      const double *const x = position.node(particle.node);
      std::array<double, 3> impulse{};
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
        {
          double &changed = rate.node(particle.node)[c];
          const double target = prescribed.node(particle.node)[c];
          impulse[c] =
              *split.unsmoothed_mass().node(particle.node) * time_step * (target - changed);
          const double work =
              impulse[c] * (v_hat.node(particle.node)[c] + 0.5 * time_step * target);
          reaction.work += work;
          changed = target;
          particle.reactions[c].add(c, impulse[c], x, work);
        }
      for (unsigned int c = 0; c < 3; ++c)
        reaction.impulse[c] += impulse[c];
      add_moment(x, impulse.data(), reaction.angular_impulse);
    }
  }

  double ConstrainedParticles::remove_from(NodalVector &change, const NodalState &state)
  {
    double work = 0;
    for (ConstrainedParticle &particle : rank_particles)
      for (unsigned int c = 0; c < 3; ++c)
        if (is_prescribed(particle, c))
        {
          const double impulse =
              *split.unsmoothed_mass().node(particle.node) * change.node(particle.node)[c];
          const double impulse_work = impulse * state.unsmoothed_velocity.node(particle.node)[c];
          const double *const x = state.position_of_unsmoothed().node(particle.node);
          reaction.add(c, impulse, x, impulse_work);
          particle.reactions[c].add(c, impulse, x, impulse_work);
          work += impulse_work;
          change.node(particle.node)[c] = 0.;
        }
    return work;
  }
} // namespace tombolo
