// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/energy_ledger.h>

#include <tombolo/base/ordered_sum.h>

#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    void add_moment(const double *position, const std::array<double, 3> &impulse,
                    std::array<double, 3> &angular_impulse)
    {
      angular_impulse[0] += position[1] * impulse[2] - position[2] * impulse[1];
      angular_impulse[1] += position[2] * impulse[0] - position[0] * impulse[2];
      angular_impulse[2] += position[0] * impulse[1] - position[1] * impulse[0];
    }

    /** Which components a half or a quarter of a symmetric body keeps by itself: momentum along the
     * planes, angular momentum about their normal if they have only one. */
    struct KeptComponents
    {
      std::array<bool, 3> momentum{{true, true, true}}, angular{{true, true, true}};

      explicit KeptComponents(const Symmetry *symmetry)
      {
        if (symmetry != nullptr)
          for (const SymmetryPlane &plane : symmetry->planes)
          {
            momentum[plane.axis] = false;
            angular[(plane.axis + 1) % 3] = angular[(plane.axis + 2) % 3] = false;
          }
      }
    };

    /** Calls @p action with the place in the list, the component, the velocity at t_{n-1/2} that
     * forces work on, which is prescribed, and what S alone would make of it, which the inertia
     * works on. */
    template <typename Action>
    void for_constrained(const NodalState &state, const Bridge &bridge,
                         const std::vector<unsigned int> &constrained_nodes,
                         const std::vector<std::uint8_t> &constrained, const Action &action)
    {
      auto smoothed = bridge.constrained_particle_velocities().begin();
      const auto smoothed_end = bridge.constrained_particle_velocities().end();
      for (std::size_t k = 0; k < constrained_nodes.size(); ++k)
      {
        const unsigned int node = constrained_nodes[k];
        while (smoothed != smoothed_end && smoothed->node < node)
          ++smoothed;
        const bool is_particle = smoothed != smoothed_end && smoothed->node == node;
        for (unsigned int d = 0; d < 3; ++d)
        {
          if (!((constrained[node] >> d) & 1u))
            continue;
          const double velocity = state.velocity.node(node)[d];
          action(k, d, velocity, is_particle ? smoothed->smoothed_velocity[d] : velocity);
        }
      }
    }

    /** How many of these nodes (ascending) come before node @p end. */
    std::size_t n_below(const std::vector<unsigned int> &nodes, const unsigned int end)
    {
      return static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), end) -
                                      nodes.begin());
    }

    double distance(const std::array<double, 3> &a, const std::array<double, 3> &b,
                    const std::array<double, 3> &c, const std::array<bool, 3> &counts)
    {
      double result = 0; // by hypot: squares of what diverges overflow
      for (unsigned int d = 0; d < 3; ++d)
        if (counts[d])
          result = std::hypot(result, a[d] - b[d] - c[d]);
      return result;
    }
  } // namespace

  void EnergyLedger::forget_load_history()
  {
    previous_load_impulse.clear();
  }

  void EnergyLedger::serialize(StateArchive &archive,
                               const std::vector<unsigned int> *const loaded_nodes,
                               const std::vector<unsigned int> *const constrained_nodes)
  {
    const auto group = archive.group("energy ledger");
    std::vector<double *> shares{&external_work, &mass_scaling};
    for (auto *vector : {&impulse, &angular_impulse, &pending_impulse, &pending_angular_impulse})
      for (double &component : *vector)
        shares.push_back(&component);
    archive.sums("work and impulses", shares);
    std::vector<double *> of_erosion{&eroded.n_cells, &eroded.mass, &eroded.energy};
    for (unsigned int d = 0; d < 3; ++d)
    {
      of_erosion.push_back(&eroded.momentum[d]);
      of_erosion.push_back(&eroded.angular_momentum[d]);
    }
    archive.sums("eroded", of_erosion);
    archive.sums("lost by conversion", {&lost_by_conversion});
    if (loaded_nodes != nullptr)
      archive.nodal("previous load impulse", *loaded_nodes, previous_load_impulse);
    if (constrained_nodes != nullptr)
    {
      archive.nodal("previous inertia", *constrained_nodes, previous_inertia);
      archive.nodal("previous force", *constrained_nodes, previous_force);
    }
    archive("filtered", filtered);
    archive("has start", has_start);
    archive("initial total", initial_total);
    archive("largest total", largest_total);
    archive("largest momentum", largest_momentum);
    archive("largest angular momentum", largest_angular_momentum);
    archive("initial momentum", initial_momentum);
    archive("initial angular momentum", initial_angular_momentum);
  }

  void EnergyLedger::add_constraint_reaction(const ConstraintReaction &reaction)
  {
    external_work += reaction.work;
    for (unsigned int d = 0; d < 3; ++d)
    {
      impulse[d] += reaction.impulse[d];
      angular_impulse[d] += reaction.angular_impulse[d];
    }
  }

  void EnergyLedger::book_first_half(const NodalState &state, const Bridge &bridge,
                                     const std::vector<unsigned int> &constrained_nodes,
                                     const std::vector<std::uint8_t> &constrained)
  {
    const auto &touched = bridge.nodes_touched_by_loads();
    const std::size_t n_touched = n_below(touched, state.partition()->n_owned());
    if (previous_load_impulse.size() >= n_touched)
      for (std::size_t k = 0; k < n_touched; ++k)
        for (unsigned int d = 0; d < 3; ++d)
          external_work += 0.5 * state.velocity.node(touched[k])[d] * previous_load_impulse[k][d];
    if (previous_inertia.size() == constrained_nodes.size())
      for_constrained(state, bridge, constrained_nodes, constrained,
                      [&](const std::size_t k, const unsigned int d, const double velocity,
                          const double inertial_velocity)
                      {
                        external_work += 0.5 * (inertial_velocity * previous_inertia[k][d] -
                                                velocity * previous_force[k][d]);
                      });
    previous_load_impulse.clear();
    previous_inertia.clear();
    previous_force.clear();
    first_half_is_booked = true;
  }

  void EnergyLedger::add_mass_scaling(const NodalState &state, const NodalVector &previous_mass)
  {
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      const double added = *state.mass.node(i) - *previous_mass.node(i);
      if (added == 0.)
        continue;
      const double *const v_hat = state.unsmoothed_velocity.node(i);
      std::array<double, 3> momentum;
      for (unsigned int d = 0; d < 3; ++d)
      {
        momentum[d] = added * v_hat[d];
        impulse[d] += momentum[d];
        mass_scaling += 0.5 * momentum[d] * v_hat[d];
      }
      add_moment(state.position.node(i), momentum, angular_impulse);
    }
  }

  void EnergyLedger::add_erosion(const ErosionLoss &loss)
  {
    eroded.n_cells += loss.n_cells;
    eroded.mass += loss.mass;
    eroded.energy += loss.energy;
    for (unsigned int d = 0; d < 3; ++d)
    {
      eroded.momentum[d] += loss.momentum[d];
      eroded.angular_momentum[d] += loss.angular_momentum[d];
    }
  }

  void EnergyLedger::add_conversion(const double lost_energy)
  {
    lost_by_conversion += lost_energy;
  }

  void EnergyLedger::add_filtered(const double energy)
  {
    filtered += energy;
  }

  void EnergyLedger::add_contact_force(const NodalState &state, const Clock &clock,
                                       const NodalVector &contact_force)
  {
    contact_impulse.fill(0.);
    contact_angular_impulse.fill(0.);
    const double velocity_step = clock.velocity_step();
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
    {
      const double *const force = contact_force.node(i);
      std::array<double, 3> step_impulse;
      for (unsigned int d = 0; d < 3; ++d)
      {
        step_impulse[d] = velocity_step * force[d];
        contact_impulse[d] += step_impulse[d];
      }
      add_moment(state.position.node(i), step_impulse, contact_angular_impulse);
    }
  }

  void EnergyLedger::accumulate(const NodalState &state, const Bridge &bridge, const Clock &clock,
                                const NodalVector *load_force,
                                const std::vector<unsigned int> &constrained_nodes,
                                const std::vector<std::uint8_t> &constrained)
  {
    const double velocity_step = clock.velocity_step();
    const unsigned int n_owned = state.partition()->n_owned();
    const bool is_start = clock.step == 0;
    // Velocities are given at t_0, so that Δt_0 is half a step; as the beginning of the first
    // interval a force counts whole, like at any other.
    const double as_previous = is_start ? 2. : 1.;
    for (unsigned int d = 0; d < 3; ++d)
    {
      impulse[d] += pending_impulse[d];
      angular_impulse[d] += pending_angular_impulse[d];
    }
    pending_impulse = std::exchange(contact_impulse, {});
    pending_angular_impulse = std::exchange(contact_angular_impulse, {});

    // K_n - K_{n-1} = ½ S v̂_{n-1/2} · (Δt_n f_n + Δt_{n-1} f_{n-1})
    if (load_force != nullptr)
    {
      const auto &touched = bridge.nodes_touched_by_loads();
      const std::size_t n_touched = n_below(touched, n_owned);
      // Ghosts among the nodes can become other ones while the owned ones, which are first, stay.
      const bool is_known = previous_load_impulse.size() >= n_touched;
      const bool has_history = is_known || first_half_is_booked;
      previous_load_impulse.resize(touched.size());
      for (std::size_t k = 0; k < n_touched; ++k)
      {
        const double *const velocity = state.velocity.node(touched[k]);
        std::array<double, 3> step_impulse;
        for (unsigned int d = 0; d < 3; ++d)
        {
          step_impulse[d] = velocity_step * load_force->node(touched[k])[d];
          if (!is_start)
            external_work +=
                0.5 * velocity[d] *
                (step_impulse[d] + (has_history ? previous_load_impulse[k][d] : step_impulse[d]));
          previous_load_impulse[k][d] = as_previous * step_impulse[d];
          pending_impulse[d] += step_impulse[d];
        }
        add_moment(state.position.node(touched[k]), step_impulse, pending_angular_impulse);
      }
    }

    if (previous_inertia.size() != constrained_nodes.size())
    {
      previous_inertia.assign(constrained_nodes.size(), {});
      previous_force.assign(constrained_nodes.size(), {});
    }
    for_constrained(state, bridge, constrained_nodes, constrained,
                    [&](const std::size_t k, const unsigned int d, const double velocity,
                        const double inertial_velocity)
                    {
                      const unsigned int node = constrained_nodes[k];
                      const double inertia = velocity_step * bridge.nodal_mass().node(node)[d] *
                                             state.acceleration.node(node)[d];
                      const double force = velocity_step * state.force.node(node)[d];
                      if (!is_start)
                        external_work +=
                            0.5 * (inertial_velocity * (inertia + previous_inertia[k][d]) -
                                   velocity * (force + previous_force[k][d]));
                      previous_inertia[k][d] = as_previous * inertia;
                      previous_force[k][d] = as_previous * force;
                      std::array<double, 3> reaction{};
                      reaction[d] = inertia - force;
                      pending_impulse[d] += reaction[d];
                      add_moment(state.position.node(node), reaction, pending_angular_impulse);
                    });
    first_half_is_booked = false;
  }

  EnergyBalance EnergyLedger::balance(NodalState &state, Bridge &bridge, const Clock &clock,
                                      const PartEnergies &parts, const ContactBalance &contact)
  {
    const MPI_Comm communicator = state.partition()->communicator();
    const unsigned int n_owned = state.partition()->n_owned();
    EnergyBalance result;

    // K at t_n needs v̂ on both sides of it; at t_0 it is given.
    const double interval = clock.step == 0 ? 0. : clock.velocity_step();
    NodalVector increment;
    increment.reinit(state.partition());
    bridge.apply_adjoint(state.position, state.acceleration, increment);
    std::array<double, 10> sums{}; // kinetic, smoothed kinetic, momentum, scale, angular, mass
    std::array<double, 4> centre{};
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double mass = *bridge.mass().node(i);
      for (unsigned int d = 0; d < 3; ++d)
        centre[d] += mass * state.position.node(i)[d];
      centre[3] += mass;
    }
    centre = ordered_sum(centre, communicator);
    double angular_scale = 0;
    for (unsigned int i = 0; i < n_owned; ++i)
    {
      const double mass = *bridge.mass().node(i);
      const double *const v_hat = state.unsmoothed_velocity.node(i);
      const double *const v = state.velocity.node(i);
      const double *const x = state.position.node(i);
      double speed = 0, arm = 0;
      std::array<double, 3> momentum;
      for (unsigned int d = 0; d < 3; ++d)
      {
        sums[0] += 0.5 * mass * v_hat[d] * (v_hat[d] + interval * increment.node(i)[d]);
        sums[1] += 0.5 * bridge.nodal_mass().node(i)[d] * v[d] * v[d];
        momentum[d] = mass * v_hat[d];
        sums[2 + d] += momentum[d];
        speed += v_hat[d] * v_hat[d];
        arm += (x[d] - centre[d] / centre[3]) * (x[d] - centre[d] / centre[3]);
      }
      sums[5] += mass * std::sqrt(speed);
      angular_scale += mass * std::sqrt(speed) * std::sqrt(arm);
      std::array<double, 3> angular{};
      add_moment(x, momentum, angular);
      for (unsigned int d = 0; d < 3; ++d)
        sums[6 + d] += angular[d];
    }
    sums[9] = angular_scale;
    sums = ordered_sum(sums, communicator);
    const std::array<double, 17> booked = ordered_sum(
        std::array<double, 17>{{parts.elastic, parts.plastic, parts.hourglass, parts.viscous,
                                external_work, impulse[0], impulse[1], impulse[2],
                                angular_impulse[0], angular_impulse[1], angular_impulse[2],
                                parts.thermal_work, mass_scaling, parts.failure, lost_by_conversion,
                                parts.contact, parts.contact_damping}},
        communicator);

    const std::array<double, 9> of_erosion = ordered_sum(
        std::array<double, 9>{{eroded.n_cells, eroded.mass, eroded.energy, eroded.momentum[0],
                               eroded.momentum[1], eroded.momentum[2], eroded.angular_momentum[0],
                               eroded.angular_momentum[1], eroded.angular_momentum[2]}},
        communicator);
    result.erosion = {of_erosion[0],
                      of_erosion[1],
                      of_erosion[2],
                      {{of_erosion[3], of_erosion[4], of_erosion[5]}},
                      {{of_erosion[6], of_erosion[7], of_erosion[8]}}};

    result.kinetic = sums[0];
    result.smoothed_kinetic = sums[1];
    result.elastic = booked[0];
    result.plastic = booked[1];
    result.hourglass = booked[2];
    result.viscous = booked[3];
    result.external_work = booked[4] + contact.external_work;
    result.thermal_work = booked[11];
    result.mass_scaling = booked[12];
    result.failure = booked[13];
    result.conversion = booked[14];
    result.self_contact = booked[15];
    result.self_contact_damping = booked[16];
    result.filtered = filtered;
    result.contact = contact.elastic;
    result.friction = contact.friction;
    result.damping = contact.damping;
    result.tool_kinetic = contact.tool_kinetic;
    result.tool_momentum = contact.tool_momentum;
    result.total = result.kinetic + result.tool_kinetic + result.elastic + result.plastic +
                   result.hourglass + result.viscous + result.filtered + result.failure +
                   result.contact + result.friction + result.damping + result.erosion.energy +
                   result.conversion + result.self_contact + result.self_contact_damping;
    for (unsigned int d = 0; d < 3; ++d)
    {
      result.momentum[d] = sums[2 + d];
      result.angular_momentum[d] = sums[6 + d];
      result.impulse[d] = booked[5 + d];
      result.angular_impulse[d] = booked[8 + d];
    }
    if (!has_start)
    {
      has_start = true;
      initial_total =
          result.total - result.external_work - result.thermal_work - result.mass_scaling;
      initial_momentum = result.momentum;
      initial_angular_momentum = result.angular_momentum;
    }
    result.short_wave_share = bridge.short_wave_share(state.unsmoothed_velocity);
    largest_total = std::max(largest_total, std::abs(result.total));
    largest_momentum = std::max(largest_momentum, sums[5]);
    largest_angular_momentum = std::max(largest_angular_momentum, sums[9]);
    result.initial_total = initial_total;
    result.momentum_scale = largest_momentum;
    result.angular_momentum_scale = largest_angular_momentum;
    const auto drift = [](const std::array<double, 3> &now, const std::array<double, 3> &start,
                          const std::array<double, 3> &given, const double scale,
                          const std::array<bool, 3> &counts)
    { return scale > 0 ? distance(now, start, given, counts) / scale : 0.; };
    const KeptComponents kept(state.partition()->symmetry());
    std::array<double, 3> all_momentum = result.momentum,
                          all_angular_momentum = result.angular_momentum;
    for (unsigned int d = 0; d < 3; ++d)
    {
      all_momentum[d] += result.erosion.momentum[d];
      all_angular_momentum[d] += result.erosion.angular_momentum[d];
    }
    result.momentum_drift =
        drift(all_momentum, initial_momentum, result.impulse, largest_momentum, kept.momentum);
    result.angular_momentum_drift =
        drift(all_angular_momentum, initial_angular_momentum, result.angular_impulse,
              largest_angular_momentum, kept.angular);
    result.error = largest_total > 0 ? (result.total - result.external_work - result.thermal_work -
                                        result.mass_scaling - initial_total) /
                                           largest_total
                                     : 0.;
    return result;
  }
} // namespace tombolo
