// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/energy_ledger.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    using Vector = std::array<double, 3>;

    /** |now + removed - start - given| over @p scale, of the components that count. */
    double drift(const Vector &now, const Vector &removed, const Vector &start, const Vector &given,
                 const std::array<bool, 3> &counts, const double scale)
    {
      if (!(scale > 0.))
        return 0.;
      double result = 0; // by hypot: squares of diverging numbers overflow
      for (unsigned int d = 0; d < 3; ++d)
        if (counts[d])
          result = std::hypot(result, (now[d] + removed[d]) - start[d] - given[d]);
      return result / scale;
    }

    /** Σ m̂ x / Σ m̂ over all ranks. Collective. */
    template <int dim>
    Vector centre_of_mass(const Model<dim> &model)
    {
      std::array<double, 4> sums{};
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        const double mass = *model.bridge->mass().node(i);
        for (unsigned int d = 0; d < 3; ++d)
          sums[d] += mass * model.state.position.node(i)[d];
        sums[3] += mass;
      }
      sums = ordered_sum(sums, model.communicator);
      return {{sums[0] / sums[3], sums[1] / sums[3], sums[2] / sums[3]}};
    }

    /** Sums over nodes. */
    struct Momenta
    {
      double kinetic = 0, smoothed_kinetic = 0;
      Vector linear{}, angular{};
      double scale = 0, angular_scale = 0;
    };

    /** K at t_n needs v̂ on both sides of it, those of the present one and @p before and @p after
     * away from it by the rate @p increment. Collective. */
    template <int dim>
    Momenta sum_over_nodes(const Model<dim> &model, const double before, const double after,
                           const NodalVector &increment)
    {
      const Vector centre = centre_of_mass(model);
      std::array<double, 10> sums{};
      double angular_scale = 0;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        const double mass = *model.bridge->mass().node(i);
        const double *const v_hat = model.state.unsmoothed_velocity.node(i);
        const double *const v = model.state.velocity.node(i);
        const double *const x = model.state.position_of_unsmoothed().node(i);
        double speed = 0, arm = 0;
        Vector momentum;
        for (unsigned int d = 0; d < 3; ++d)
        {
          const double rate = increment.node(i)[d];
          sums[0] += 0.5 * mass * (v_hat[d] - before * rate) * (v_hat[d] + after * rate);
          if (mass > 0.) // else nodal_mass() is a divisor only
            sums[1] += 0.5 * model.bridge->nodal_mass().node(i)[d] * v[d] * v[d];
          momentum[d] = mass * v_hat[d];
          sums[2 + d] += momentum[d];
          speed += v_hat[d] * v_hat[d];
          arm += (x[d] - centre[d]) * (x[d] - centre[d]);
        }
        sums[5] += mass * std::sqrt(speed);
        angular_scale += mass * std::sqrt(speed) * std::sqrt(arm);
        Vector angular{};
        add_moment(x, momentum.data(), angular);
        for (unsigned int d = 0; d < 3; ++d)
          sums[6 + d] += angular[d];
      }
      sums[9] = angular_scale;
      sums = ordered_sum(sums, model.communicator);
      return {sums[0], sums[1], {{sums[2], sums[3], sums[4]}}, {{sums[6], sums[7], sums[8]}},
              sums[5], sums[9]};
    }
  } // namespace

  template <int dim>
  EnergyBalance EnergyLedger::balance(const Model<dim> &model, const Clock &clock,
                                      const double unresolved)
  {
    EnergyBalance result;
    // Where v̂ is given at t_0, it is in the middle of its interval.
    const double after = clock.velocity_step(),
                 before = clock.has_present_velocities() ? after : 0.;
    NodalVector increment(model.state.partition());
    model.bridge->apply_adjoint(model.state.acceleration, increment);
    // Reactions at prescribed components are booked with the motion that follows; at t_0 there was
    // one before.
    for (const ConstrainedParticle &particle :
         model.bridge->get_constrained_particles().particles())
      for (unsigned int d = 0; clock.has_present_velocities() && d < 3; ++d)
        if ((particle.components >> d) & 1u)
          increment.node(particle.node)[d] = model.state.acceleration.node(particle.node)[d];
    const Momenta momenta = sum_over_nodes(model, before, after, increment);

    EnergyAccounts &energies = result.energies;
    energies.add_replicated("kinetic energy", EnergyKind::stored, momenta.kinetic);
    for (const Part<dim> &part : model.parts)
      energies.add(part.formulation->energies());
    energies.add("external work", EnergyKind::external, 0.);
    model.impulses.account(energies);
    for (const auto &process : model.processes)
      process->add_energies(energies);
    energies.sum_over_ranks(model.communicator);

    result.smoothed_kinetic = momenta.smoothed_kinetic;
    result.momentum = momenta.linear;
    result.angular_momentum = momenta.angular;
    result.impulse = energies.impulse;
    result.angular_impulse = energies.angular_impulse;
    result.total = energies.total();
    result.external = energies.sum_of(EnergyKind::external);
    if (!has_start)
    {
      has_start = true;
      initial_total = result.total - result.external;
      initial_momentum = result.momentum;
      initial_angular_momentum = result.angular_momentum;
    }
    result.initial_total = initial_total;
    result.short_wave_share = model.bridge->short_wave_share(model.state.unsmoothed_velocity);
    largest_input = std::max(largest_input, std::abs(initial_total + result.external));
    largest_momentum = std::max(largest_momentum, momenta.scale);
    largest_angular_momentum = std::max(largest_angular_momentum, momenta.angular_scale);
    find_drifts(model, result);
    const double error = result.total - result.external - initial_total;
    // The largest of values of which one is not a number can be zero.
    const bool has_scale = largest_input > 0. || std::isnan(error);
    result.error = has_scale && !(std::abs(error) <= unresolved) ? error / largest_input : 0.;
    return result;
  }

  template <int dim>
  void EnergyLedger::find_drifts(const Model<dim> &model, EnergyBalance &result)
  {
    // A half or a quarter of a symmetric body conserves the other components by itself.
    const Images &images = model.state.partition()->images_of_body();
    std::array<bool, 3> keeps_momentum, keeps_angular_momentum;
    for (unsigned int d = 0; d < 3; ++d)
    {
      keeps_momentum[d] = !images.are_opposite_along(d);
      keeps_angular_momentum[d] = !images.are_opposite_about(d);
    }
    result.momentum_scale = largest_momentum;
    result.angular_momentum_scale = largest_angular_momentum;
    result.momentum_drift =
        drift(result.momentum, result.energies.removed_momentum, initial_momentum, result.impulse,
              keeps_momentum, largest_momentum);
    result.angular_momentum_drift = drift(
        result.angular_momentum, result.energies.removed_angular_momentum, initial_angular_momentum,
        result.angular_impulse, keeps_angular_momentum, largest_angular_momentum);
  }

  void EnergyLedger::list(Records &records, EnergyBalance &last)
  {
    records.value("has start", has_start);
    records.value("initial total", initial_total);
    records.value("largest input", largest_input);
    records.value("largest momentum", largest_momentum);
    records.value("largest angular momentum", largest_angular_momentum);
    records.value("initial momentum", initial_momentum);
    records.value("initial angular momentum", initial_angular_momentum);
    records.value("last error", last.error);
    records.value("last momentum drift", last.momentum_drift);
    records.value("last angular momentum drift", last.angular_momentum_drift);
    records.value("last short wave share", last.short_wave_share);
  }

  template EnergyBalance EnergyLedger::balance(const Model<2> &, const Clock &, double);
  template EnergyBalance EnergyLedger::balance(const Model<3> &, const Clock &, double);
} // namespace tombolo
