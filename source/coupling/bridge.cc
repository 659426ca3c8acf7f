// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/bridge.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  Bridge::Bridge(const unsigned int dim, const SmoothingSettings &smoothing, const bool trace,
                 const ReflectionParity under_reflection)
      : dim(dim), settings(smoothing), trace(trace), reflection(under_reflection)
  {}

  void Bridge::set_smoothed_parts(const std::vector<bool> &are_smoothed)
  {
    parts.resize(are_smoothed.size());
    for (std::size_t p = 0; p < parts.size(); ++p)
      parts[p].is_smoothed = are_smoothed[p];
  }

  void Bridge::reinit(const std::shared_ptr<const NodePartition> &partition,
                      const std::vector<Stencils *> &particle_parts,
                      const NodalVector &element_mass, const std::vector<std::uint8_t> &constrained,
                      const std::vector<double> &weights,
                      const std::vector<std::vector<double>> &row_weights)
  {
    Assert(weights.empty() || weights.size() == particle_parts.size(), ExcInternalError());
    Assert(row_weights.empty() || row_weights.size() == particle_parts.size(), ExcInternalError());
    const auto mass_of = [&](const unsigned int p, const unsigned int row)
    {
      const double mass = (weights.empty() ? 1. : weights[p]) * particle_parts[p]->mass[row];
      return row_weights.empty() ? mass : row_weights[p][row] * mass;
    };
    const unsigned int n_owned = partition->n_owned();
    momentum_is_current = false;
    place_in_own.clear();

    total_mass.reinit(partition, 1);
    std::vector<unsigned int> n_particle_parts(n_owned, 0);
    for (unsigned int i = 0; i < n_owned; ++i)
      *total_mass.node(i) = *element_mass.node(i);
    parts.resize(particle_parts.size());
    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      const Stencils &shape = *particle_parts[p];
      parts[p].shape = particle_parts[p];
      parts[p].is_smoothed = parts[p].is_smoothed && settings.is_active;
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        *total_mass.node(shape.particle_node[row]) += mass_of(p, row);
        n_particle_parts[shape.particle_node[row]] += parts[p].is_smoothed ? 1 : 0;
      }
    }
    shared_by_particle_parts = std::any_of(n_particle_parts.begin(), n_particle_parts.end(),
                                           [](const unsigned int count) { return count > 1; });
    total_mass.update_ghosts();

    // What is not smoothed is the node's own.
    std::vector<double> own(static_cast<std::size_t>(n_owned) * node_stride);
    for (unsigned int i = 0; i < n_owned; ++i)
      std::fill_n(own.begin() + static_cast<std::ptrdiff_t>(i) * node_stride, node_stride,
                  *total_mass.node(i));

    for (unsigned int p = 0; p < parts.size(); ++p)
    {
      ParticlePart &part = parts[p];
      const unsigned int n_rows = part.shape->n_particles();
      part.smoothed_mass.resize_fast(static_cast<std::size_t>(n_rows) * node_stride);
      part.smoothed_fraction.resize_fast(static_cast<std::size_t>(n_rows) * node_stride);
      part.element_rows.clear();
      for (unsigned int row = 0; row < n_rows; ++row)
      {
        const unsigned int node = part.shape->particle_node[row];
        const double of_elements = *element_mass.node(node);
        if (of_elements > 0)
          part.element_rows.push_back(row);
        double smoothed = part.is_smoothed ? mass_of(p, row) : 0.;
        if (trace && part.is_smoothed)
          smoothed *= *total_mass.node(node) / (*total_mass.node(node) - of_elements);
        for (unsigned int c = 0; c < node_stride; ++c)
        {
          const bool is_free = constrained.empty() || !((constrained[node] >> c) & 1u);
          const double mass = is_free ? smoothed : 0.;
          part.smoothed_mass[row * node_stride + c] = mass;
          part.smoothed_fraction[row * node_stride + c] = mass / *total_mass.node(node);
          own[static_cast<std::size_t>(node) * node_stride + c] -= mass;
        }
      }
    }

    constrained_particles.clear();
    if (settings.is_active && !constrained.empty())
      for (unsigned int i = 0; i < n_owned; ++i)
        if (constrained[i] != 0 && n_particle_parts[i] > 0)
          constrained_particles.push_back({i, constrained[i], {{0., 0., 0.}}});
    constrained_particles_anywhere =
        Utilities::MPI::max(constrained_particles.empty() ? 0 : 1, partition->communicator()) == 1;

    own_nodes.clear();
    own_mass.resize(0);
    own_fraction.resize(0);
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      double *const of_node = own.data() + static_cast<std::size_t>(i) * node_stride;
      bool has_own = false;
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        // Round-off of the subtraction is not mass.
        if (std::abs(of_node[c]) < 1e-13 * *total_mass.node(i))
          of_node[c] = 0.;
        has_own = has_own || of_node[c] != 0.;
      }
      if (!has_own)
        continue;
      own_nodes.push_back(i);
      for (unsigned int c = 0; c < node_stride; ++c)
      {
        own_mass.push_back(of_node[c]);
        own_fraction.push_back(of_node[c] / *total_mass.node(i));
      }
    }

    momentum.reinit(partition, node_stride, reflection);
    work.reinit(partition, node_stride, reflection);
    mass_by_component.reinit(partition, node_stride, ReflectionParity::even);
    if (settings.is_active && !parts.empty() && settings.gamma != 0.)
      second_work.reinit(partition, node_stride, reflection);
    if (settings.is_active && !parts.empty() && (settings.affine || settings.gamma != 0.))
      third_work.reinit(partition, node_stride, reflection);
    if (trace)
    {
      trace_velocity.reinit(partition, node_stride, reflection);
      trace_force.reinit(partition, node_stride, reflection);
    }

    update_nodal_mass();
    has_started = true;
  }

  void Bridge::add_own_momentum(const NodalVector &velocity, NodalVector &result) const
  {
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
    {
      double *const target = result.node(own_nodes[k]);
      store_node(load_node(target) + load_node(own_mass.data() + k * node_stride) *
                                         load_node(velocity.node(own_nodes[k])),
                 target);
    }
  }

  void Bridge::momentum_to_velocity(NodalVector &velocity)
  {
    momentum.add_to_owners();
    const unsigned int n_owned = momentum.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(momentum.node(i)) / load_node(mass_by_component.node(i)),
                 velocity.node(i));
    velocity.update_ghosts();
  }

  void Bridge::apply_paper_smoothing(const NodalVector &unsmoothed, NodalVector &smoothed)
  {
    momentum_is_current = false;
    momentum.set_zero();
    // In the order of add_interpolated_motion(), whose sums a resumed run takes here.
    for (const ParticlePart &part : parts)
      if (part.is_smoothed)
        NodalSmoothing::scatter(*part.shape, part.smoothed_mass.data(), unsmoothed.data(),
                                momentum.data());
    add_own_momentum(unsmoothed, momentum);
    momentum_to_velocity(smoothed);
  }

  void Bridge::apply_interpolation(const NodalVector &field, NodalVector &result)
  {
    result.set_zero();
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
      store_node(load_node(own_fraction.data() + k * node_stride) *
                     load_node(field.node(own_nodes[k])),
                 result.node(own_nodes[k]));
    for (const ParticlePart &part : parts)
      if (part.is_smoothed)
        NodalSmoothing::gather(*part.shape, part.smoothed_fraction.data(), field.data(),
                               result.data());
    result.update_ghosts();
  }

  void Bridge::apply_short_wave_part(const NodalVector &field, NodalVector &result)
  {
    apply_paper_smoothing(field, work);
    apply_interpolation(work, result);
    const std::size_t n = static_cast<std::size_t>(result.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      result.data()[i] = field.data()[i] - result.data()[i];
  }

  void Bridge::apply_smoothing(const NodalVector &position, const NodalVector &unsmoothed,
                               NodalVector &smoothed)
  {
    if (!settings.is_active || parts.empty())
    {
      smoothed.copy_from(unsmoothed);
      smoothed.update_ghosts();
      return;
    }
    if (settings.affine)
    {
      momentum_is_current = false;
      momentum.set_zero();
      add_own_momentum(unsmoothed, momentum);
      for (ParticlePart &part : parts)
      {
        if (!part.is_smoothed)
          continue;
        if (dim == 2)
          NodalSmoothing::scatter_affine<2>(*part.shape, part.smoothed_mass.data(), position.data(),
                                            unsmoothed.data(), momentum.data());
        else
          NodalSmoothing::scatter_affine<3>(*part.shape, part.smoothed_mass.data(), position.data(),
                                            unsmoothed.data(), momentum.data());
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
    apply_short_wave_part(unsmoothed, second_work);
    const std::size_t n = static_cast<std::size_t>(smoothed.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      second_work.data()[i] = unsmoothed.data()[i] + settings.gamma * second_work.data()[i];
    apply_paper_smoothing(second_work, smoothed);
  }

  void Bridge::collect_affine_adjoint(const NodalVector &position, const NodalVector &field)
  {
    momentum_is_current = false;
    momentum.set_zero();
    add_own_momentum(field, momentum);
    for (ParticlePart &part : parts)
    {
      if (!part.is_smoothed)
        continue;
      if (!part.shape->inverse_deformation_is_current)
      {
        if (dim == 2)
          NodalSmoothing::update_inverse_deformation<2>(position.data(), *part.shape);
        else
          NodalSmoothing::update_inverse_deformation<3>(position.data(), *part.shape);
      }
      NodalSmoothing::gather_affine(*part.shape, part.smoothed_mass.data(), position.data(),
                                    field.data(), momentum.data());
    }
    momentum.add_to_owners();
  }

  void Bridge::apply_adjoint(const NodalVector &position, const NodalVector &field,
                             NodalVector &result)
  {
    if (!settings.is_active || parts.empty())
    {
      result.copy_from(field);
      result.update_ghosts();
      return;
    }
    if (settings.affine)
    {
      collect_affine_adjoint(position, field);
      const unsigned int n_owned = momentum.partition()->n_owned();
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        const double mass = *total_mass.node(i);
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
    apply_interpolation(field, second_work);
    apply_short_wave_part(second_work, result);
    const std::size_t n = static_cast<std::size_t>(result.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      result.data()[i] = second_work.data()[i] + settings.gamma * result.data()[i];
  }

  void Bridge::smooth_velocity(NodalState &state)
  {
    if (momentum_is_current)
      momentum_to_velocity(state.velocity);
    else
      apply_smoothing(state.position, state.unsmoothed_velocity, state.velocity);
    momentum_is_current = false;
    // A prescribed component of a particle is what was prescribed, not its neighbours' mean.
    for (ConstrainedParticle &particle : constrained_particles)
    {
      double *const velocity = state.velocity.node(particle.node);
      for (unsigned int c = 0; c < 3; ++c)
        if ((particle.components >> c) & 1u)
        {
          particle.smoothed_velocity[c] = velocity[c];
          velocity[c] = state.unsmoothed_velocity.node(particle.node)[c];
        }
    }
    if (constrained_particles_anywhere)
      state.velocity.update_ghosts();
  }

  const std::vector<Bridge::ConstrainedParticle> &Bridge::constrained_particle_velocities() const
  {
    return constrained_particles;
  }

  Bridge::Operators Bridge::operators() const
  {
    if (!settings.is_active || parts.empty())
      return Operators::identity;
    if (settings.affine)
      return Operators::affine;
    return settings.gamma == 0. ? Operators::interpolation : Operators::sharpened;
  }

  void Bridge::add_interpolated_motion(const NodalVector &velocity, const NodalVector &acceleration,
                                       const double velocity_step, const double position_step,
                                       NodalVector &v_hat, NodalVector &x)
  {
    for (std::size_t k = 0; k < own_nodes.size(); ++k)
    {
      const unsigned int i = own_nodes[k];
      const NodeLanes fraction = load_node(own_fraction.data() + k * node_stride);
      const NodeLanes increment = load_node(acceleration.node(i)) * velocity_step;
      store_node(load_node(v_hat.node(i)) + fraction * increment, v_hat.node(i));
      store_node(load_node(x.node(i)) +
                     fraction * (load_node(velocity.node(i)) + increment) * position_step,
                 x.node(i));
    }
    if (operators() == Operators::identity)
      return;
    // With a node in two particle parts its velocity is complete only after the second.
    const bool scatter_now = !shared_by_particle_parts;
    if (scatter_now)
      momentum.set_zero();
    for (const ParticlePart &part : parts)
      if (part.is_smoothed)
        NodalSmoothing::gather_motion(
            *part.shape, part.smoothed_fraction.data(), part.smoothed_mass.data(), velocity.data(),
            acceleration.data(), velocity_step, position_step, v_hat.data(), x.data(),
            scatter_now ? momentum.data() : nullptr);
    // A shared node has the particles' share of its velocity only now.
    if (scatter_now)
      add_own_momentum(v_hat, momentum);
    momentum_is_current = scatter_now;
  }

  const NodalVector &Bridge::momentum_rate(const NodalVector &position,
                                           const NodalVector &acceleration,
                                           const NodalVector &v_hat, const double time_step)
  {
    collect_affine_adjoint(position, acceleration);
    const auto scale = [&](const unsigned int node, const double factor)
    { store_node(load_node(momentum.node(node)) * factor, momentum.node(node)); };
    for (const ConstrainedParticle &particle : constrained_particles)
      scale(particle.node, 1. / *total_mass.node(particle.node));
    restore_constrained(momentum, acceleration, v_hat, position, time_step);
    for (const ConstrainedParticle &particle : constrained_particles)
      scale(particle.node, *total_mass.node(particle.node));
    return momentum;
  }

  void Bridge::velocity_rate(const NodalVector &position, const NodalVector &acceleration,
                             const NodalVector &v_hat, const double time_step, NodalVector &rate)
  {
    apply_adjoint(position, acceleration, rate);
    restore_constrained(rate, acceleration, v_hat, position, time_step);
    momentum_is_current = false;
  }

  void Bridge::positions_have_changed()
  {
    for (ParticlePart &part : parts)
      part.shape->inverse_deformation_is_current = false;
  }

  void Bridge::restore_constrained(NodalVector &rate, const NodalVector &prescribed,
                                   const NodalVector &v_hat, const NodalVector &position,
                                   const double time_step)
  {
    for (const ConstrainedParticle &particle : constrained_particles)
    {
      const double *const x = position.node(particle.node);
      std::array<double, 3> impulse{};
      for (unsigned int c = 0; c < 3; ++c)
        if ((particle.components >> c) & 1u)
        {
          double &changed = rate.node(particle.node)[c];
          const double wanted = prescribed.node(particle.node)[c];
          impulse[c] = *total_mass.node(particle.node) * time_step * (wanted - changed);
          reaction.work += impulse[c] * (v_hat.node(particle.node)[c] + 0.5 * time_step * wanted);
          changed = wanted;
        }
      for (unsigned int c = 0; c < 3; ++c)
      {
        const unsigned int d = (c + 1) % 3, e = (c + 2) % 3;
        reaction.impulse[c] += impulse[c];
        reaction.angular_impulse[c] += x[d] * impulse[e] - x[e] * impulse[d];
      }
    }
  }

  ConstraintReaction Bridge::take_constraint_reaction()
  {
    return std::exchange(reaction, {});
  }

  double Bridge::filter(NodalState &state, const LatticeFilterSettings &filter_settings,
                        const double elapsed)
  {
    if (filter_settings.power == 0 || !settings.is_active || parts.empty())
      return 0.;
    const double before = kinetic_energy(state.unsmoothed_velocity);
    const double delta = std::min(1., filter_settings.strength * filter_settings.rate * elapsed);
    if (third_work.partition() != state.partition())
      third_work.reinit(state.partition());
    if (second_work.partition() != state.partition())
      second_work.reinit(state.partition());
    third_work.copy_from(state.unsmoothed_velocity);
    NodalVector *from = &third_work;
    NodalVector *to = &second_work;
    for (unsigned int k = 0; k < filter_settings.power; ++k)
    {
      apply_short_wave_part(*from, *to);
      std::swap(from, to);
    }
    const unsigned int n_owned = state.partition()->n_owned();
    for (const ConstrainedParticle &particle : constrained_particles)
      for (unsigned int c = 0; c < 3; ++c)
        if ((particle.components >> c) & 1u)
        {
          reaction.impulse[c] +=
              *total_mass.node(particle.node) * delta * from->node(particle.node)[c];
          from->node(particle.node)[c] = 0.;
        }
    for (unsigned int i = 0; i < n_owned; ++i)
      store_node(load_node(state.unsmoothed_velocity.node(i)) - load_node(from->node(i)) * delta,
                 state.unsmoothed_velocity.node(i));
    state.unsmoothed_velocity.update_ghosts();
    momentum_is_current = false;
    return before - kinetic_energy(state.unsmoothed_velocity);
  }

  const NodalVector &Bridge::nodal_mass() const
  {
    return mass_by_component;
  }

  const NodalVector &Bridge::mass() const
  {
    return total_mass;
  }

  bool Bridge::has_particles() const
  {
    return !parts.empty();
  }

  bool Bridge::is_trace() const
  {
    return trace;
  }

  const SmoothingSettings &Bridge::smoothing() const
  {
    return settings;
  }

  double Bridge::kinetic_energy(const NodalVector &unsmoothed) const
  {
    double sum = 0;
    const unsigned int n_owned = unsmoothed.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double *const v = unsmoothed.node(i);
      sum += 0.5 * *total_mass.node(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    return ordered_sum(sum, unsmoothed.partition()->communicator());
  }

  double Bridge::short_wave_share(const NodalVector &unsmoothed)
  {
    if (!settings.is_active || parts.empty())
      return 0.;
    const double before = kinetic_energy(unsmoothed);
    if (before == 0.)
      return 0.;
    apply_paper_smoothing(unsmoothed, work);
    double local = 0;
    const unsigned int n_owned = unsmoothed.partition()->n_owned();
    for (unsigned int i = 0; i < n_owned; ++i)
      for (unsigned int c = 0; c < 3; ++c)
        local += 0.5 * mass_by_component.node(i)[c] * work.node(i)[c] * work.node(i)[c];
    return 1. - ordered_sum(local, unsmoothed.partition()->communicator()) / before;
  }

  std::size_t Bridge::memory_consumption() const
  {
    std::size_t bytes = own_nodes.capacity() * sizeof(unsigned int) +
                        own_mass.memory_consumption() + own_fraction.memory_consumption();
    for (const ParticlePart &part : parts)
      bytes +=
          part.smoothed_mass.memory_consumption() + part.smoothed_fraction.memory_consumption();
    for (const NodalVector *vector : {&total_mass, &mass_by_component, &momentum, &work,
                                      &second_work, &third_work, &trace_velocity, &trace_force})
      bytes += vector->memory_consumption();
    return bytes;
  }
} // namespace tombolo
