// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/bridge.h>

#include <tombolo/approximation/nodal_smoothing.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/ordered_sum.h>

#include <string>

namespace tombolo
{
  Bridge::Bridge(const SmoothingSettings &smoothing, const bool trace, const Quantity quantity)
      : settings(smoothing), trace(trace), quantity(quantity),
        split(smoothing, trace, quantity == Quantity::vector),
        loads(split, smoothing.is_active && smoothing.affine && quantity == Quantity::vector),
        trace_transfer(split), constrained_particles(split)
  {}

  void Bridge::reinit(const std::shared_ptr<const NodePartition> &partition,
                      const MassSplit::Masses &masses)
  {
    momentum_is_current = velocity_is_current = false;
    loads.reset_rows();
    split.reinit(partition, masses);

    if (settings.is_active)
      constrained_particles.reinit(masses.constrained);

    momentum.reinit(partition, quantity);
    scratch.reinit(partition, quantity);
    const bool has_smoothing = settings.is_active && !split.parts.empty();
    if (has_smoothing && settings.gamma != 0.)
      second_scratch.reinit(partition, quantity);
    update_nodal_mass();
  }

  void Bridge::update_nodal_mass()
  {
    momentum_is_current = velocity_is_current = false;
    if (!split.update_nodal_mass())
      throw RunError(
          std::string("The smoothed mass of a particle is not positive: its neighbours are too few "
                      "or too one-sided for the kernel. A larger dilation helps") +
          (trace && settings.affine ? "; with elements much heavier than the particles, the bridge "
                                      "`paper` or another smoothing than `affine`."
                                    : "."));
  }

  void Bridge::momentum_to_velocity(NodalVector &velocity)
  {
    momentum.add_to_owners();
    const unsigned int n_owned = momentum.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(momentum.node(i)) / load_node(split.row_sums().node(i)),
                 velocity.node(i));
    velocity.distribute();
  }

  void Bridge::apply_paper_smoothing(const NodalVector &unsmoothed, NodalVector &smoothed)
  {
    momentum_is_current = false;
    momentum.set_zero();
    // In the order of add_interpolated_motion(), whose sums a resumed run computes here.
    for (const MassSplit::ParticlePart &part : split.parts)
      if (part.is_smoothed)
        NodalSmoothing::scatter(*part.shape, part.smoothed_mass.data(), unsmoothed.data(),
                                momentum.data());
    split.add_own_momentum(unsmoothed, momentum);
    momentum_to_velocity(smoothed);
  }

  void Bridge::apply_interpolation(const NodalVector &field, NodalVector &result)
  {
    split.set_own_fraction(field, result);
    for (const MassSplit::ParticlePart &part : split.parts)
      if (part.is_smoothed)
        NodalSmoothing::gather(*part.shape, part.smoothed_fraction.data(), field.data(),
                               result.data());
    result.update_ghosts();
  }

  void Bridge::apply_short_wave_part(const NodalVector &field, NodalVector &result)
  {
    apply_paper_smoothing(field, scratch);
    apply_interpolation(scratch, result);
    const std::size_t n = static_cast<std::size_t>(result.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      result.data()[i] = field.data()[i] - result.data()[i];
  }

  void Bridge::apply_smoothing(const NodalVector &unsmoothed, NodalVector &smoothed)
  {
    velocity_is_current = false; // the caller may have changed it
    if (!settings.is_active || split.parts.empty())
    {
      smoothed.copy_from(unsmoothed);
      smoothed.distribute();
      return;
    }
    if (settings.affine)
    {
      momentum_is_current = false;
      momentum.set_zero();
      split.add_own_momentum(unsmoothed, momentum);
      for (const MassSplit::ParticlePart &part : split.parts)
        if (part.is_smoothed)
        {
          Assert(part.shape->reference_position.partition() == unsmoothed.partition(),
                 ExcInternalError());
          NodalSmoothing::scatter_affine(*part.shape, part.smoothed_mass.data(), unsmoothed.data(),
                                         momentum.data());
        }
      momentum_to_velocity(smoothed);
      return;
    }
    if (settings.gamma == 0.)
    {
      apply_paper_smoothing(unsmoothed, smoothed);
      return;
    }
    // S (v̂ + γ T v̂)
    apply_short_wave_part(unsmoothed, second_scratch);
    const std::size_t n = static_cast<std::size_t>(smoothed.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      second_scratch.data()[i] = unsmoothed.data()[i] + settings.gamma * second_scratch.data()[i];
    apply_paper_smoothing(second_scratch, smoothed);
  }

  void Bridge::collect_affine_adjoint(const NodalVector &nodal_values)
  {
    momentum_is_current = false;
    momentum.set_zero();
    const NodalVector &field = split.field_over_row_sums(nodal_values);
    split.add_own_momentum(field, momentum);
    for (const MassSplit::ParticlePart &part : split.parts)
      if (part.is_smoothed)
        NodalSmoothing::gather_affine(*part.shape, part.smoothed_mass.data(), field.data(),
                                      momentum.data());
    momentum.add_to_owners();
  }

  void Bridge::apply_adjoint(const NodalVector &field, NodalVector &result)
  {
    if (!settings.is_active || split.parts.empty())
    {
      result.copy_from(field);
      result.update_ghosts();
      return;
    }
    if (settings.affine)
    {
      collect_affine_adjoint(field);
      const unsigned int n_owned = momentum.partition()->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        const double mass = *split.unsmoothed_mass().node(i);
        store_node(load_node(momentum.node(i)) / (mass > 0. ? mass : 1.), result.node(i));
      }
      result.update_ghosts();
      return;
    }
    if (settings.gamma == 0.)
    {
      apply_interpolation(field, result);
      return;
    }
    // (I + γT) Φ a
    apply_interpolation(field, second_scratch);
    apply_short_wave_part(second_scratch, result);
    const std::size_t n = static_cast<std::size_t>(result.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      result.data()[i] = second_scratch.data()[i] + settings.gamma * result.data()[i];
  }

  void Bridge::smooth_velocity(NodalState &state)
  {
    if (velocity_is_current)
      return;
    if (momentum_is_current)
      momentum_to_velocity(state.velocity);
    else
      apply_smoothing(state.unsmoothed_velocity, state.velocity);
    momentum_is_current = false;
    // A prescribed component of a particle is what was prescribed, not its neighbours' mean.
    constrained_particles.keep_velocity(state.unsmoothed_velocity, state.velocity);
  }

  void Bridge::move_with_smoothed_velocity(NodalState &state, const double time_step)
  {
    velocity_is_current = false;
    smooth_velocity(state);
    velocity_is_current = true;
    constrained_particles.move(time_step, state.velocity);
    const unsigned int n_owned = state.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      add_to_node(load_node(state.velocity.node(i)) * time_step, state.position.node(i));
      add_to_node(load_node(state.unsmoothed_velocity.node(i)) * time_step,
                  state.unsmoothed_position.node(i));
    }
  }

  Bridge::Operators Bridge::operators() const
  {
    if (!settings.is_active || split.parts.empty())
      return Operators::identity;
    if (settings.affine)
      return Operators::affine;
    return settings.gamma == 0. ? Operators::interpolation : Operators::sharpened;
  }

  void Bridge::add_interpolated_motion(const NodalVector &velocity, const NodalVector &acceleration,
                                       const double velocity_step, const double position_step,
                                       NodalVector &v_hat, NodalVector &x)
  {
    for (std::size_t k = 0; k < split.own_nodes.size(); ++k)
    {
      const unsigned int i = split.own_nodes[k];
      const NodeLanes fraction = split.own_fraction_of(k);
      const NodeLanes increment = load_node(acceleration.node(i)) * velocity_step;
      add_to_node(fraction * increment, v_hat.node(i));
      add_to_node(fraction * (load_node(velocity.node(i)) + increment) * position_step, x.node(i));
    }
    if (operators() == Operators::identity)
      return;
    // With a node in two particle split.parts its velocity is complete only after the second.
    const bool scatter_now = !split.shared_by_particle_parts;
    if (scatter_now)
      momentum.set_zero();
    for (const MassSplit::ParticlePart &part : split.parts)
      if (part.is_smoothed)
        NodalSmoothing::gather_motion(
            *part.shape, part.smoothed_fraction.data(), part.smoothed_mass.data(), velocity.data(),
            acceleration.data(), velocity_step, position_step, v_hat.data(), x.data(),
            scatter_now ? momentum.data() : nullptr);
    // A shared node has the particles' share of its velocity only now.
    if (scatter_now)
      split.add_own_momentum(v_hat, momentum);
    momentum_is_current = scatter_now;
  }

  const NodalVector &Bridge::momentum_rate(const NodalState &state, const double time_step)
  {
    collect_affine_adjoint(state.acceleration);
    const auto scale = [&](const unsigned int node, const double factor)
    { store_node(load_node(momentum.node(node)) * factor, momentum.node(node)); };
    for (const ConstrainedParticle &particle : constrained_particles.particles())
      scale(particle.node, 1. / *split.unsmoothed_mass().node(particle.node));
    constrained_particles.restore(momentum, state.acceleration, state.unsmoothed_velocity,
                                  state.position_of_unsmoothed(), time_step);
    for (const ConstrainedParticle &particle : constrained_particles.particles())
      scale(particle.node, *split.unsmoothed_mass().node(particle.node));
    return momentum;
  }

  void Bridge::velocity_rate(const NodalState &state, const double time_step, NodalVector &rate)
  {
    apply_adjoint(state.acceleration, rate);
    constrained_particles.restore(rate, state.acceleration, state.unsmoothed_velocity,
                                  state.position_of_unsmoothed(), time_step);
    momentum_is_current = false;
  }

  void Bridge::positions_have_changed()
  {
    for (MassSplit::ParticlePart &part : split.parts)
      part.shape->inverse_deformation_is_current = false;
  }

  double Bridge::remove_from_velocity(NodalVector &change, NodalState &state)
  {
    const double work = constrained_particles.remove_from(change, state);
    for (unsigned int i = 0; i < change.partition()->n_owned(); ++i)
      store_node(load_node(state.unsmoothed_velocity.node(i)) - load_node(change.node(i)),
                 state.unsmoothed_velocity.node(i));
    state.unsmoothed_velocity.distribute();
    momentum_is_current = velocity_is_current = false;
    return work;
  }

  double Bridge::short_wave_share(const NodalVector &unsmoothed)
  {
    if (!settings.is_active || split.parts.empty())
      return 0.;
    const double before = MassSplit::kinetic_energy(split.total_mass, unsmoothed);
    if (before == 0.)
      return 0.;
    apply_paper_smoothing(unsmoothed, scratch);
    double local = 0;
    const unsigned int n_owned = unsmoothed.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      for (unsigned int c = 0; c < 3; ++c)
        local += 0.5 * split.row_sums().node(i)[c] * scratch.node(i)[c] * scratch.node(i)[c];
    return 1. - ordered_sum(local, unsmoothed.partition()->communicator()) / before;
  }
} // namespace tombolo
